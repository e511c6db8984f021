#include "pipeline/object_book.hpp"

#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"

namespace beltpick::pipeline {
namespace {

constexpr std::size_t kLabels = 65536;
constexpr double kExplainedShare = 0.75;  // of a segment: the rest is its rim, or a neighbour's

bool near(const Segment& a, const Segment& b, int reach_px) {
  return a.row_min <= b.row_max + reach_px && b.row_min <= a.row_max + reach_px && a.col_min <= b.col_max + reach_px &&
         b.col_min <= a.col_max + reach_px;
}

}  // namespace

ObjectBook::ObjectBook(Arena& arena, const Limits& limits)
    : owner_(arena.take_image<std::uint16_t>("objects: unexplained pixels", limits.image_height, limits.image_width)),
      entries_(arena.take<Entry>("objects: book", static_cast<std::size_t>(limits.segments))),
      entry_of_label_(arena.take<std::uint16_t>("objects: book", kLabels)),
      objects_(arena.take<Object>("objects: book", static_cast<std::size_t>(limits.segments))) {}

void ObjectBook::begin(const result::Scene& scene, std::span<const Segment> segments, double least_area_mm2) {
  owner_ = {owner_.data, scene.labels.rows, scene.labels.cols};
  for (int row = 0; row < owner_.rows; ++row) std::copy_n(scene.labels.row(row), owner_.cols, owner_.row(row));
  std::fill(entry_of_label_.begin(), entry_of_label_.end(), std::uint16_t{0});
  entry_count_ = std::min(segments.size(), entries_.size());
  for (std::size_t i = 0; i < entry_count_; ++i) {
    entries_[i] = {};
    entries_[i].segment = segments[i];
    entries_[i].pixels_at_start = segments[i].pixels;
    entry_of_label_[segments[i].label] = static_cast<std::uint16_t>(i + 1);
  }
  least_area_mm2_ = least_area_mm2;
  round_ = 0;
}

ObjectBook::Entry* ObjectBook::entry(std::uint16_t label) {
  const std::uint16_t at = entry_of_label_[label];
  return at == 0 ? nullptr : &entries_[at - 1U];
}

// What is left of each segment: its pixels, their box, and the surface they see.
void ObjectBook::recount(const result::Scene& scene) {
  for (Entry& e : entries_.first(entry_count_)) {
    e.segment.pixels = 0;
    e.segment.row_min = owner_.rows, e.segment.row_max = -1, e.segment.col_min = owner_.cols, e.segment.col_max = -1;
    e.area_mm2 = 0.0;
  }
  const double per_focal2 = 1.0 / (scene.lens.fx_px * scene.lens.fy_px);
  for (int row = 0; row < owner_.rows; ++row) {
    const std::uint16_t* labels = owner_.row(row);
    for (int col = 0; col < owner_.cols; ++col) {
      if (labels[col] == 0) continue;
      Entry* e = entry(labels[col]);
      if (e == nullptr) continue;
      Segment& s = e->segment;
      ++s.pixels;
      s.row_min = std::min(s.row_min, row), s.row_max = std::max(s.row_max, row);
      s.col_min = std::min(s.col_min, col), s.col_max = std::max(s.col_max, col);
      const double z = scene.range.point_mm(row, col).z();
      e->area_mm2 += z * z * per_focal2;
    }
  }
}

std::span<const Object> ObjectBook::next_round(const result::Scene& scene, double reach_mm) {
  recount(scene);
  object_count_ = 0;
  for (Entry& e : entries_.first(entry_count_)) {
    // The search would find again what it found, unless a fifth has been taken away since.
    const bool changed = e.pixels_when_tried < 0 || e.segment.pixels < 4 * e.pixels_when_tried / 5;
    if (!changed || e.segment.pixels == 0) continue;
    if (e.area_mm2 < least_area_mm2_) {
      if (round_ == 0) {
        e.failed = true;
        e.reason = failure(ResultCode::kObjectTooSmall,
                           "%.0f mm2 in view, expected at least %.0f; dirt, or a part "
                           "mostly hidden",
                           e.area_mm2, least_area_mm2_)
                       .error();
      }
      e.pixels_when_tried = e.segment.pixels;
      continue;
    }
    e.pixels_when_tried = e.segment.pixels;
    e.failed = false;
    objects_[object_count_] = {};
    objects_[object_count_++].add(e.segment);
  }
  if (round_ > 0) join_neighbours(reach_mm);
  ++round_;
  return objects_.first(object_count_);
}

// A part that shadows cut into pieces: pieces that found nothing, together with those next to them.
void ObjectBook::join_neighbours(double reach_mm) {
  for (std::size_t i = 0; i < entry_count_ && object_count_ < objects_.size(); ++i) {
    if (!entries_[i].failed || entries_[i].joined || entries_[i].segment.pixels == 0) continue;
    const Segment& seed = entries_[i].segment;
    const double pitch_mm = std::sqrt(entries_[i].area_mm2 / seed.pixels);
    const int reach_px = static_cast<int>(reach_mm / pitch_mm);
    Object object;
    object.add(seed);
    for (std::size_t j = 0; j < entry_count_; ++j) {
      if (j == i || !entries_[j].failed || entries_[j].segment.pixels == 0) continue;
      if (near(seed, entries_[j].segment, reach_px)) object.add(entries_[j].segment);
    }
    entries_[i].joined = true;
    if (object.label_count > 1) objects_[object_count_++] = object;
  }
}

void ObjectBook::explain(const result::Scene& scene, const PartModel& model, const result::PartPose& T_camera_part,
                         const result::Region& region) {
  // Rims are measured less well than the surfaces that the tolerance is made for.
  const float tolerance_mm = static_cast<float>(3.0 * result::surface_tolerance_mm(scene, model.spacing_mm));
  const auto T_part_camera = T_camera_part.inverse();
  const Eigen::Matrix3f rotation = T_part_camera.rotation.cast<float>();
  const Vec3f translation = T_part_camera.translation_mm.cast<float>();
  for (int row = std::max(0, region.row_min); row <= std::min(owner_.rows - 1, region.row_max); ++row) {
    for (int col = std::max(0, region.col_min); col <= std::min(owner_.cols - 1, region.col_max); ++col) {
      if (owner_(row, col) == 0 || !scene.range.valid(row, col)) continue;
      const Vec3f at = rotation * scene.range.point_mm(row, col) + translation;
      if ((model.nearest(at).point_mm - at).norm() < tolerance_mm + model.spacing_mm) owner_(row, col) = 0;
    }
  }
}

void ObjectBook::failed(const Object& object, Stage stage, const Error& reason) {
  for (int i = 0; i < object.label_count; ++i) {
    Entry* e = entry(object.labels[i]);
    if (e == nullptr) continue;
    const bool known = e->reason.code == ResultCode::kPoseAmbiguous;
    e->failed = true;
    if (known) continue;  // what is left of an ambiguous part adds nothing
    e->stage = stage;
    e->reason = reason;
  }
}

std::size_t ObjectBook::withheld(std::span<WithheldObject> out) const {
  std::size_t count = 0;
  for (const Entry& e : entries_.first(entry_count_)) {
    const bool explained = e.segment.pixels < (1.0 - kExplainedShare) * e.pixels_at_start ||
                           (e.segment.pixels < e.pixels_at_start && e.area_mm2 < least_area_mm2_);
    // What an ambiguous pose explains is explained by nothing that is offered.
    const bool ambiguous = e.reason.code == ResultCode::kPoseAmbiguous;
    if ((ambiguous || (!explained && e.failed)) && count < out.size())
      out[count++] = {e.segment.label, e.stage, e.reason};
  }
  return count;
}

}  // namespace beltpick::pipeline
