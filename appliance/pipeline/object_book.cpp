#include "pipeline/object_book.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/each_set.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::pipeline {
namespace {

constexpr std::size_t kLabels = 65536;
constexpr double kExplainedShare = 0.75;  // of a segment: the rest is its rim, or a neighbour's
// Of the smallest view of the smallest part: what shows less is not searched by itself, what shows more is no fragment.
constexpr double kLeastViewShare = 0.08;
constexpr double kWholeViewShare = 0.5;

bool near(const Segment& a, const Segment& b, int reach_px) {
  return a.row_min <= b.row_max + reach_px && b.row_min <= a.row_max + reach_px && a.col_min <= b.col_max + reach_px &&
         b.col_min <= a.col_max + reach_px;
}

// As they are now: of what has been taken away of them since, the count of pixels tells.
bool same_pieces(const Object& a, const Object& b) {
  const std::span labels(a.labels, static_cast<std::size_t>(a.label_count));
  return a.label_count == b.label_count && a.pixels == b.pixels &&
         std::all_of(labels.begin(), labels.end(), [&](std::uint16_t label) { return b.holds(label); });
}

}  // namespace

ObjectBook::ObjectBook(Arena& arena, const Limits& limits)
    : owner_(arena.take_image<std::uint16_t>("objects: unexplained pixels", limits.image_height, limits.image_width)),
      entries_(arena.take<Entry>("objects: book", static_cast<std::size_t>(limits.segments))),
      entry_of_label_(arena.take<std::uint16_t>("objects: book", kLabels)),
      objects_(arena.take<Object>("objects: book", static_cast<std::size_t>(limits.segments))) {}

void ObjectBook::begin(const result::Scene& scene, std::span<const Segment> segments, double smallest_view_mm2) {
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
  smallest_view_mm2_ = smallest_view_mm2;
  recount_due_ = true;
}

ObjectBook::Entry* ObjectBook::entry(std::uint16_t label) {
  const std::uint16_t at = entry_of_label_[label];
  return at == 0 ? nullptr : &entries_[at - 1U];
}

const ObjectBook::Entry* ObjectBook::entry(std::uint16_t label) const {
  const std::uint16_t at = entry_of_label_[label];
  return at == 0 ? nullptr : &entries_[at - 1U];
}

// What is left of each segment: its pixels, their box, and the surface they see.
void ObjectBook::recount(const result::Scene& scene) {
  if (!recount_due_) return;
  recount_due_ = false;
  for (Entry& e : entries_.first(entry_count_)) {
    e.segment.pixels = 0;
    e.segment.row_min = owner_.rows, e.segment.row_max = -1, e.segment.col_min = owner_.cols, e.segment.col_max = -1;
    e.area_mm2 = 0.0;
  }
  const double per_focal2 = 1.0 / (scene.lens.fx_px * scene.lens.fy_px);
  for (int row = 0; row < owner_.rows; ++row) {
    const std::span<const std::uint16_t> labels{owner_.row(row), static_cast<std::size_t>(owner_.cols)};
    each_set(labels, [&](std::size_t at) {
      const int col = static_cast<int>(at);
      Entry* e = entry(labels[at]);
      if (e == nullptr) return;
      Segment& s = e->segment;
      ++s.pixels;
      s.row_min = std::min(s.row_min, row), s.row_max = std::max(s.row_max, row);
      s.col_min = std::min(s.col_min, col), s.col_max = std::max(s.col_max, col);
      const double z = scene.range.point_mm(row, col).z();
      e->area_mm2 += z * z * per_focal2;
    });
  }
}

// An object of which a fifth has been taken away since is another one: the search may find what it did not.
void ObjectBook::renew(Entry& e) const {
  if (e.pixels_when_new >= 0 && e.segment.pixels >= 4 * e.pixels_when_new / 5) return;
  const bool at_start = e.pixels_when_new < 0;
  const double least_mm2 = kLeastViewShare * smallest_view_mm2_;
  e.pixels_when_new = e.segment.pixels;
  e.given_up = e.segment.pixels == 0 || e.area_mm2 < least_mm2;
  if (!e.given_up) {
    e.next = Effort::kPrimitives;
    e.claimed = e.nearest.ambiguous();
    if (!e.claimed) e.nearest = {};
  } else if (at_start) {
    e.nearest.stage = Stage::kSegment;
    e.nearest.reason = failure(ResultCode::kObjectTooSmall,
                               "%.0f mm2 in view, expected at least %.0f; dirt, or a part "
                               "mostly hidden",
                               e.area_mm2, least_mm2)
                           .error();
  }
}

// Neighbourhoods help where a pose was found that is not quite right: between two parts.
bool ObjectBook::came_near(const Entry& e) { return e.nearest.stage == Stage::kVerify && !e.nearest.ambiguous(); }

// The lower, the earlier it is searched.
int ObjectBook::turn(const Entry& e) const {
  constexpr int kAfterWhole = static_cast<int>(Effort::kNeighbourhoods);
  const int effort = static_cast<int>(e.next);
  if (e.next == Effort::kNeighbourhoods) return effort + kAfterWhole;
  return e.area_mm2 >= kWholeViewShare * smallest_view_mm2_ ? effort : effort + kAfterWhole;
}

std::span<const Object> ObjectBook::next_round(const result::Scene& scene, double reach_mm) {
  recount(scene);
  object_count_ = 0;
  const auto entries = entries_.first(entry_count_);
  int first = std::numeric_limits<int>::max();
  for (Entry& e : entries) {
    renew(e);
    if (!e.given_up) first = std::min(first, turn(e));
  }
  for (Entry& e : entries) {
    if (e.given_up || turn(e) != first) continue;
    effort_ = e.next;
    if (effort_ == Effort::kPieces) {
      e.next = Effort::kViews;
      add_joined(e, reach_mm, [](const Entry& other) { return !other.given_up || other.nearest.failed(); });
    } else {
      objects_[object_count_] = {};
      objects_[object_count_++].add(e.segment);
    }
  }
  if (object_count_ > 0) return objects_.first(object_count_);
  if (first < std::numeric_limits<int>::max()) return next_round(scene, reach_mm);  // no piece had another next to it
  join_failed(reach_mm);
  return objects_.first(object_count_);
}

// What found nothing, together with what found nothing next to it.
void ObjectBook::join_failed(double reach_mm) {
  for (const Effort effort : {Effort::kJoined, Effort::kJoinedNeighbourhoods}) {
    effort_ = effort;
    for (Entry& e : entries_.first(entry_count_)) {
      if (e.joined >= effort || !e.nearest.failed() || e.segment.pixels == 0) continue;
      e.joined = effort;
      if (effort == Effort::kJoinedNeighbourhoods && !came_near(e)) continue;
      add_joined(e, reach_mm, [](const Entry& other) { return other.nearest.failed(); });
    }
    if (object_count_ > 0) return;
  }
}

// A new object of the seed and those next to it that belong, if there are any, and it was not searched already.
template <class Belongs>
void ObjectBook::add_joined(Entry& seed, double reach_mm, const Belongs& belongs) {
  const double pitch_mm = std::sqrt(seed.area_mm2 / seed.segment.pixels);
  const int reach_px = static_cast<int>(reach_mm / pitch_mm);
  Object object;
  object.add(seed.segment);
  for (const Entry& other : entries_.first(entry_count_)) {
    if (&other == &seed || !belongs(other) || other.segment.pixels == 0) continue;
    if (near(seed.segment, other.segment, reach_px)) object.add(other.segment);
  }
  if (object.label_count < 2 || searched_already(object)) return;
  objects_[object_count_++] = object;
  seed.pieces = object;
}

// The same pieces, begun with another one: in this round; or before, where it would be the same search again.
bool ObjectBook::searched_already(const Object& object) const {
  const auto same = [&](const Object& other) { return same_pieces(object, other); };
  if (effort_ == Effort::kJoined) {
    const std::span labels(object.labels, static_cast<std::size_t>(object.label_count));
    return std::any_of(labels.begin(), labels.end(), [&](std::uint16_t label) { return same(entry(label)->pieces); });
  }
  const auto objects = objects_.first(object_count_);
  return std::any_of(objects.begin(), objects.end(), same);
}

void ObjectBook::explain(const result::Scene& scene, const PartModel& model, const result::PartPose& T_camera_part,
                         const result::Region& region) {
  // Rims are measured less well than the surfaces that the tolerance is made for.
  const float reach_mm =
      static_cast<float>(3.0 * result::surface_tolerance_mm(scene, model.spacing_mm)) + model.spacing_mm;
  const auto T_part_camera = T_camera_part.inverse();
  const Eigen::Matrix3f rotation = T_part_camera.rotation.cast<float>();
  const Vec3f translation = T_part_camera.translation_mm.cast<float>();
  for (int row = std::max(0, region.row_min); row <= std::min(owner_.rows - 1, region.row_max); ++row) {
    for (int col = std::max(0, region.col_min); col <= std::min(owner_.cols - 1, region.col_max); ++col) {
      if (owner_(row, col) == 0 || !scene.range.valid(row, col)) continue;
      const Vec3f at = rotation * scene.range.point_mm(row, col) + translation;
      if (model.outside_box_mm(at) > reach_mm + 0.01F) continue;
      if ((model.nearest(at).point_mm - at).squaredNorm() < reach_mm * reach_mm) owner_(row, col) = 0;
    }
  }
  recount_due_ = true;
}

void ObjectBook::failed(const Object& object, const Attempt& attempt) {
  // Pieces were joined for the first one's sake; the others have had no search of their own yet, or will.
  const int meant = effort_ == Effort::kPieces ? 1 : object.label_count;
  for (int i = 0; i < meant; ++i) {
    Entry* e = entry(object.labels[i]);
    if (e == nullptr) continue;
    // What is left of a part with an ambiguous pose adds nothing.
    const bool known = e->claimed || (e->given_up && e->nearest.ambiguous());
    if (!known && attempt.failed() && attempt.nearer_than(e->nearest)) e->nearest = attempt;
    if (effort_ == Effort::kPieces || effort_ >= Effort::kJoined) continue;
    const bool hopeless = attempt.reason.code == ResultCode::kObjectTooSmall ||
                          attempt.reason.code == ResultCode::kDuplicatePose || effort_ == Effort::kNeighbourhoods;
    e->given_up = hopeless || (effort_ == Effort::kViews && !came_near(*e));
    if (!e->given_up) e->next = static_cast<Effort>(static_cast<int>(effort_) + 1);
  }
}

const Attempt* ObjectBook::last_word(const Object& object) const {
  const Entry* e = entry(object.labels[0]);
  return e != nullptr && e->given_up && e->nearest.failed() ? &e->nearest : nullptr;
}

std::size_t ObjectBook::withheld(std::span<WithheldObject> out) const {
  std::size_t count = 0;
  for (const Entry& e : entries_.first(entry_count_)) {
    const bool explained = e.segment.pixels < (1.0 - kExplainedShare) * e.pixels_at_start ||
                           (e.segment.pixels < e.pixels_at_start && e.area_mm2 < kLeastViewShare * smallest_view_mm2_);
    // What an ambiguous pose explains is explained by nothing that is offered.
    if ((e.nearest.ambiguous() || (!explained && e.nearest.failed())) && count < out.size())
      out[count++] = {e.segment.label, e.nearest.stage, e.nearest.reason};
  }
  return count;
}

}  // namespace beltpick::pipeline
