#include "result/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "result/camera_view.hpp"
#include "result/outline.hpp"

namespace beltpick::result {
namespace {

// A part is taken to lie under the belt only beyond this depth: belts are not flat.
constexpr double kSunk_mm = 3.0;
// Of eight places round a missing one, so many measured as expected tell that the surface is there.
constexpr int kLeastSpeckles = 2;
// A surface that leans away more makes no impression: it is rarely measured.
constexpr float kLeastCosine = 0.2F;

struct Tolerance {
  float surface_mm;
  float free_space_mm;
};

// Of points inside the image: nothing to round is negative.
int pixel_row(const VisiblePoint& point) { return static_cast<int>(point.row_px + 0.5F); }
int pixel_column(const VisiblePoint& point) { return static_cast<int>(point.column_px + 0.5F); }

// One measured point against the surface expected on its line of sight.
Finding compare(const Vec3f& measured, const Vec3f& expected, const Vec3f& normal, const Tolerance& tolerance) {
  if (measured.z() <= 0.0F) return Finding::kMissing;
  const Vec3f apart = measured - expected;
  if (std::abs(normal.dot(apart)) < tolerance.surface_mm) return Finding::kMatched;
  const float behind = measured.norm() - expected.norm();
  if (behind > tolerance.free_space_mm) return Finding::kViolated;
  return behind < -tolerance.free_space_mm ? Finding::kOccluded : Finding::kContradicted;
}

// Whether the light falls on the surface: what is turned away from the projector is not measured.
bool lit(const VisiblePoint& point, const std::optional<Vec3f>& light_mm) {
  if (!light_mm) return true;
  const Vec3f toward = *light_mm - point.point_mm;
  return point.normal.dot(toward) > 0.15F * toward.norm();
}

bool in_shadow(const Scene& scene, const Vec3f& point_mm, const Vec3f& normal, const Tolerance& tolerance) {
  return scene.shadows != nullptr && scene.shadows->hides(point_mm, normal, tolerance.free_space_mm);
}

// Whether the part itself stands between its surface and the light: follows the light's path by as much as the surface
// is away, so that nothing is passed by unseen.
class OwnShadow {
 public:
  OwnShadow(const PartModel& model, const PartPose& T_camera_part, const std::optional<Vec3f>& light_mm)
      : model_(model) {
    const auto T_part_camera = T_camera_part.inverse();
    rotation_ = T_part_camera.rotation.cast<float>();
    translation_ = T_part_camera.translation_mm.cast<float>();
    if (light_mm) light_part_mm_ = rotation_ * *light_mm + translation_;
  }

  [[nodiscard]] bool hides(const Vec3f& point_mm, const Vec3f& normal) const {
    if (!light_part_mm_) return false;
    const float spacing_mm = model_.spacing_mm;
    Vec3f at = rotation_ * (point_mm + 1.5F * spacing_mm * normal) + translation_;
    const Vec3f towards = (*light_part_mm_ - at).normalized();
    for (int step = 0; step < kMostSteps && model_.outside_box_mm(at) < 0.0F; ++step) {
      const float free_mm = (model_.nearest(at).point_mm - at).norm();
      if (free_mm < 0.6F * spacing_mm) return true;
      at += std::max(0.5F * spacing_mm, free_mm - 0.6F * spacing_mm) * towards;
    }
    return false;
  }

 private:
  static constexpr int kMostSteps = 64;

  const PartModel& model_;
  Eigen::Matrix3f rotation_;
  Vec3f translation_;
  std::optional<Vec3f> light_part_mm_;
};

// The surface point against the pixels round it: matched if any matches, for a pose that is right may be a pixel off;
// violated only if all agree, so that seeing past an edge is no evidence.
class Lookup {
 public:
  Lookup(const Scene& scene, const PartModel& model, const PartPose& T_camera_part, Tolerance tolerance, int reach_px)
      : range_(scene.range),
        model_(model),
        T_part_camera_(T_camera_part.inverse()),
        tolerance_(tolerance),
        reach_px_(reach_px) {}

  // Adds the squared distance of a match to `square_mm2`.
  Finding look(const VisiblePoint& point, double& square_mm2) const {
    const int row = pixel_row(point);
    const int col = pixel_column(point);
    const Finding centre = at(row, col, point);
    if (centre == Finding::kMatched) {
      const double distance = point.normal.dot(range_.point_mm(row, col) - point.point_mm);
      square_mm2 += point.area * distance * distance;
      return centre;
    }
    if (centre == Finding::kMissing && speckled(row, col, point)) return Finding::kShadowed;
    if (centre != Finding::kViolated) return centre;
    for (const auto& [dr, dc] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const Finding beside = at(row + dr * reach_px_, col + dc * reach_px_, point);
      if (beside != Finding::kViolated) return Finding::kMissing;
    }
    return on_part(range_.point_mm(row, col)) ? Finding::kMissing : Finding::kViolated;
  }

 private:
  // Whether the surface was measured here and there around: light falls on it too flat, or is thrown back too strongly,
  // for all of it to be measured.
  [[nodiscard]] bool speckled(int row, int col, const VisiblePoint& point) const {
    int matched = 0;
    for (const int away_px : {2 * reach_px_, 5 * reach_px_}) {
      for (const auto& [dr, dc] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
        matched += at(row + dr * away_px, col + dc * away_px, point) == Finding::kMatched ? 1 : 0;
    }
    return matched >= kLeastSpeckles;
  }

  [[nodiscard]] Finding at(int row, int col, const VisiblePoint& point) const {
    if (!range_.point_mm.contains(row, col)) return Finding::kMissing;
    return compare(range_.point_mm(row, col), point.point_mm, point.normal, tolerance_);
  }

  // Whether the point lies on some other surface of the part after all, one that looks towards the camera: the belt
  // seen through a hole that should not be there lies on the underside.
  [[nodiscard]] bool on_part(const Vec3f& measured_mm) const {
    const Vec3f at = (T_part_camera_ * measured_mm.cast<double>()).cast<float>();
    const OrientedPoint& nearest = model_.nearest(at);
    const Vec3f towards_camera = T_part_camera_.translation_mm.cast<float>() - at;
    return nearest.normal.dot(towards_camera) > 0.0F &&
           (nearest.point_mm - at).norm() < tolerance_.surface_mm + model_.spacing_mm;
  }

  const RangeImage& range_;
  const PartModel& model_;
  Pose<frame::Part, frame::Camera> T_part_camera_;
  Tolerance tolerance_;
  int reach_px_;
};

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

Evidence weigh(const Drawing& drawing, const PartModel& model, const PartPose& T_camera_part, const Scene& scene,
               const Claimed& claimed, FindingListener* listener) {
  const double tolerance_mm = surface_tolerance_mm(scene, model.spacing_mm);
  const Tolerance tolerance{static_cast<float>(tolerance_mm),
                            static_cast<float>(free_space_tolerance_mm(scene, model.spacing_mm))};
  const Lookup lookup(scene, model, T_camera_part, tolerance, std::max(1, drawing.factor() / 2));
  Evidence evidence;
  double total = 0.0, inside = 0.0, matched = 0.0, violated = 0.0, occluded = 0.0, contradicted = 0.0, shadowed = 0.0,
         unexplained = 0.0, missing = 0.0, square_mm2 = 0.0;
  int points = 0;
  std::optional<Vec3f> light_mm;
  if (scene.light_mm) light_mm = scene.light_mm->cast<float>();
  const OwnShadow own(model, T_camera_part, light_mm);
  for (const VisiblePoint& point : drawing.visible()) {
    if (!lit(point, light_mm)) continue;
    total += point.area;
    if (!point.in_image) continue;
    inside += point.area;
    ++points;
    Finding finding = lookup.look(point, square_mm2);
    if (finding == Finding::kMissing &&
        (in_shadow(scene, point.point_mm, point.normal, tolerance) || own.hides(point.point_mm, point.normal))) {
      finding = Finding::kShadowed;
    }
    if (listener != nullptr) listener->found(point, finding);
    switch (finding) {
      case Finding::kMatched:
        matched += point.area;
        break;
      case Finding::kViolated:
        violated += point.area;
        break;
      case Finding::kOccluded:
        occluded += point.area;
        if (claimed.holds(pixel_row(point), pixel_column(point))) unexplained += point.area;
        break;
      case Finding::kContradicted:
        contradicted += point.area;
        break;
      case Finding::kShadowed:
        shadowed += point.area;
        break;
      case Finding::kMissing:
        missing += point.area;
        break;
    }
  }
  const double judged = inside - occluded - shadowed;
  evidence.points = static_cast<int>(static_cast<float>(points) * drawing.stands_for());
  evidence.in_view = share(inside, total);
  evidence.matched = matched;
  evidence.support = share(matched, total);
  evidence.coverage = share(matched, judged);
  evidence.violated = share(violated, judged);
  evidence.contradicted = share(contradicted + violated, matched + contradicted + violated);
  evidence.occluded = share(occluded, inside);
  evidence.shadowed = share(shadowed, inside);
  evidence.unexplained = share(unexplained, inside);
  if (scene.light_mm) evidence.gaps = share(missing, total);
  evidence.continued = continued_outline(drawing, model, T_camera_part, scene, tolerance_mm);
  if (scene.belt) evidence.sunk = sunk_share(model, T_camera_part, *scene.belt, tolerance_mm);
  evidence.rms_mm = std::sqrt(share(square_mm2, matched));
  return evidence;
}

double sunk_share(const PartModel& model, const PartPose& T_camera_part, const Plane& belt, double tolerance_mm) {
  if (model.scattered.empty()) return 0.0;
  // Height as a function of the part's own coordinates: one product a point.
  const Vec3f slope = (T_camera_part.rotation.transpose() * belt.normal).cast<float>();
  const auto zero = static_cast<float>(belt.height_mm(T_camera_part.translation_mm));
  const auto lowest = static_cast<float>(-std::max(kSunk_mm, 4.0 * tolerance_mm));
  int sunk = 0;
  for (const PointBlock& block : model.scattered) {
    for (std::size_t k = 0; k < PointBlock::kSize; ++k) {
      const float height_mm = slope.x() * block.x[k] + slope.y() * block.y[k] + slope.z() * block.z[k] + zero;
      sunk += height_mm < lowest ? 1 : 0;
    }
  }
  return sunk / static_cast<double>(model.scattered.size() * PointBlock::kSize);
}

Impression first_impression(const PartModel& model, const PartPose& T_camera_part, const Scene& scene,
                            double tolerance_mm) {
  const FastMotion motion(T_camera_part);
  const Optics optics(scene.lens);
  const Tolerance tolerance{static_cast<float>(tolerance_mm), static_cast<float>(2.0 * tolerance_mm)};
  int judged = 0, unjudged = 0, matched = 0, violated = 0;
  PointBlock points;
  Seen seen;
  for (const PointBlock& block : model.scattered) {
    move_points(block, motion, PointBlock::kSize, points);
    look_at(points, optics, model.spacing_mm, PointBlock::kSize, seen);
    for (std::size_t k = 0; k < PointBlock::kSize; ++k) {
      if (seen.cosine[k] < kLeastCosine) continue;
      ++unjudged;
      if (seen.facing[k] == 0) continue;
      const int row = static_cast<int>(std::lround(seen.row_px[k]));
      const int col = static_cast<int>(std::lround(seen.column_px[k]));
      if (!scene.range.point_mm.contains(row, col)) continue;
      const Vec3f point(points.x[k], points.y[k], points.z[k]), normal(points.nx[k], points.ny[k], points.nz[k]);
      const Finding finding = compare(scene.range.point_mm(row, col), point, normal, tolerance);
      if (finding == Finding::kOccluded) continue;
      if (finding == Finding::kMissing && in_shadow(scene, point, normal, tolerance)) continue;
      ++judged;
      --unjudged;
      matched += finding == Finding::kMatched ? 1 : 0;
      violated += finding == Finding::kViolated ? 1 : 0;
    }
  }
  if (judged == 0) return {};
  const double sunk = scene.belt ? sunk_share(model, T_camera_part, *scene.belt, tolerance_mm) : 0.0;
  return {std::max(-2.0, (matched - 2.0 * violated) / (judged + 0.5 * unjudged) - 2.0 * sunk), share(violated, judged)};
}

}  // namespace beltpick::result
