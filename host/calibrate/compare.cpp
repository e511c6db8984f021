#include "calibrate/compare.hpp"

#include <algorithm>
#include <cmath>

#include "base/stages.hpp"
#include "calibrate/belt_frame.hpp"
#include "calibrate/triangulate.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::calibrate {
namespace {

constexpr int kFewestPoints = 12;

Result<void> check_sizes(const Lens& old_lens, const Lens& new_lens, const char* which) {
  if (old_lens.width == new_lens.width && old_lens.height == new_lens.height) return {};
  return failure(
      ResultCode::kCalibrationMismatch,
      "%s: expected both calibrations of one rig, found images of %dx%d and %dx%d; compare calibrations of the "
      "same camera, projector and region",
      which, old_lens.width, old_lens.height, new_lens.width, new_lens.height);
}

// The belt in the camera frame, its normal towards the camera.
Result<Plane> belt_plane(const Calibration& calibration, const std::optional<Cell>& cell, const CompareOptions& options,
                         bool& guessed) {
  if (cell && cell->T_belt_camera && !options.distance_mm) {
    return belt_plane_of(*cell->T_belt_camera);
  }
  guessed = !options.distance_mm;
  const auto distance_mm = guessed ? crossing_depth_mm(calibration) : options.distance_mm;
  if (distance_mm) return Plane{-Vec3::UnitZ(), -*distance_mm};
  return failure(ResultCode::kTooFewPoints,
                 "the centres of the two images do not meet in front of the rig, so the belt's distance is not known; "
                 "give --distance-mm or --cell");
}

// The point of a camera pixel's ray at `height_mm` above the belt; nothing behind the camera.
std::optional<Vec3> point_at(const Lens& camera, const PixelPosition& pixel, const Plane& belt, double height_mm) {
  const auto ray = ray_of(camera, pixel);
  if (!ray) return std::nullopt;
  const double depth_mm = (belt.offset_mm + height_mm) / belt.normal.dot(*ray);
  if (!(depth_mm > 0.0) || !std::isfinite(depth_mm)) return std::nullopt;
  return depth_mm * *ray;
}

std::optional<ComparedPoint> compare_at(const Calibration& old_calibration, const Calibration& new_calibration,
                                        const PixelPosition& pixel, const Vec3& old_mm, Axis axis) {
  const Vec3 lit_mm = old_calibration.T_projector_camera * old_mm;
  if (!in_field(old_calibration.projector, lit_mm)) return std::nullopt;
  const PixelPosition lit = project(old_calibration.projector, lit_mm);
  if (!on_image(old_calibration.projector, lit)) return std::nullopt;
  const double code_px = axis == Axis::kColumn ? lit.column_px : lit.row_px;
  const auto new_mm = triangulate(new_calibration, pixel, axis, code_px, old_mm.z());
  if (!new_mm) return std::nullopt;
  return ComparedPoint{pixel, old_mm, *new_mm, 0};
}

std::vector<ComparedPoint> compare_grid(const Calibration& old_calibration, const Calibration& new_calibration,
                                        const Plane& belt, Axis axis, const PixelPosition& step_px,
                                        const CompareOptions& options) {
  std::vector<ComparedPoint> points;
  const Lens& camera = old_calibration.camera;
  for (int layer = 0; layer < options.layers; ++layer) {
    const double height_mm = options.height_mm * layer / std::max(1, options.layers - 1);
    for (int r = 0; r < options.rows; ++r) {
      for (int c = 0; c < options.columns; ++c) {
        const PixelPosition pixel{step_px.column_px * c, step_px.row_px * r};
        const auto old_mm = point_at(camera, pixel, belt, height_mm);
        if (!old_mm) continue;
        auto point = compare_at(old_calibration, new_calibration, pixel, *old_mm, axis);
        if (!point) continue;
        point->layer = layer;
        points.push_back(*point);
      }
    }
  }
  return points;
}

Spread spread_of(const std::vector<ComparedPoint>& points, const RigidFit& motion, bool belt_only) {
  Spread spread;
  double sum = 0.0;
  for (const ComparedPoint& point : points) {
    if (belt_only && point.layer != 0) continue;
    const double off_mm = (motion * point.new_mm - point.old_mm).norm();
    sum += off_mm * off_mm;
    spread.max_mm = std::max(spread.max_mm, off_mm);
    ++spread.points;
  }
  if (spread.points > 0) spread.rms_mm = std::sqrt(sum / spread.points);
  return spread;
}

RigidFit best_motion(const std::vector<ComparedPoint>& points) {
  std::vector<Vec3> from_mm, to_mm;
  for (const ComparedPoint& point : points) {
    from_mm.push_back(point.new_mm);
    to_mm.push_back(point.old_mm);
  }
  return fit_rigid(from_mm, to_mm);
}

}  // namespace

Result<Comparison> compare(const Calibration& old_calibration, const Calibration& new_calibration,
                           const std::optional<Cell>& cell, const CompareOptions& options) {
  if (auto same = check_sizes(old_calibration.camera, new_calibration.camera, "camera"); !same) {
    return std::unexpected(same.error());
  }
  if (auto same = check_sizes(old_calibration.projector, new_calibration.projector, "projector"); !same) {
    return std::unexpected(same.error());
  }
  Comparison comparison;
  const auto belt = belt_plane(old_calibration, cell, options, comparison.distance_guessed);
  if (!belt) return std::unexpected(belt.error());
  comparison.axis = sensitive_axis(old_calibration);
  comparison.distance_mm = belt->offset_mm / belt->normal.z();
  comparison.height_mm = options.height_mm;
  comparison.image_width = old_calibration.camera.width;
  comparison.image_height = old_calibration.camera.height;
  comparison.grid_step_px = {(comparison.image_width - 1.0) / (options.columns - 1),
                             (comparison.image_height - 1.0) / (options.rows - 1)};
  comparison.points =
      compare_grid(old_calibration, new_calibration, *belt, comparison.axis, comparison.grid_step_px, options);
  const auto on_belt = std::count_if(comparison.points.begin(), comparison.points.end(),
                                     [](const ComparedPoint& point) { return point.layer == 0; });
  if (on_belt < kFewestPoints) {
    return failure(
        ResultCode::kTooFewPoints,
        "at %.0f mm camera and projector share too little of the belt (%d of %d grid points); give the belt's "
        "distance by --distance-mm or --cell",
        comparison.distance_mm, static_cast<int>(on_belt), options.columns * options.rows);
  }
  comparison.belt = spread_of(comparison.points, {}, true);
  comparison.volume = spread_of(comparison.points, {}, false);
  comparison.motion = best_motion(comparison.points);
  comparison.belt_moved = spread_of(comparison.points, comparison.motion, true);
  comparison.volume_moved = spread_of(comparison.points, comparison.motion, false);
  return comparison;
}

}  // namespace beltpick::calibrate
