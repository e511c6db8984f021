#include "range/triangulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/camera_noise.hpp"
#include "contract/result_codes.hpp"
#include "range/lens_model.hpp"

namespace beltpick::range {
namespace {

// How far, in projector pixels, codes may stand from where the geometry puts them: calibration error and lens residue.
constexpr float kModelSlackPx = 3.0F;
constexpr float kAgreeSigmas = 5.0F;
// A camera's footprint noise: none; a projector coordinate's: see CodeNoise.
float code_sigma_px(const CodeNoise& noise, float modulation, float texture) {
  const float level_sigma = std::sqrt(kCameraNoise.variance(0.5F * texture));
  const float slope = noise.slope_px * level_sigma / std::max(modulation, 1e-3F);
  return std::sqrt(noise.floor_px * noise.floor_px + slope * slope);
}

}  // namespace

Triangulator::Triangulator(Arena& arena, int rows, int cols) : max_rows_(rows), max_cols_(cols), edges_(arena, cols) {
  const std::size_t pixels = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  ray_u_ = arena.take<float>("camera rays", pixels);
  ray_v_ = arena.take<float>("camera rays", pixels);
  point_mm_ = arena.take<Vec3f>("range image", pixels);
  sigma_mm_ = arena.take<float>("range image", pixels);
  for (AxisScratch& scratch : scratch_) {
    scratch.depth_mm = arena.take<float>("range scratch", static_cast<std::size_t>(cols));
    scratch.mm_per_px = arena.take<float>("range scratch", static_cast<std::size_t>(cols));
    scratch.other_px = arena.take<float>("range scratch", static_cast<std::size_t>(cols));
  }
}

Result<void> Triangulator::load(const Calibration& calibration) {
  const Lens& camera = calibration.camera;
  if (camera.width > max_cols_ || camera.height > max_rows_) {
    return failure(ResultCode::kLimitExceeded, "the calibration's camera image of %dx%d exceeds the declared %dx%d",
                   camera.width, camera.height, max_cols_, max_rows_);
  }
  rows_ = camera.height;
  cols_ = camera.width;
  focal_px_ = static_cast<float>(std::min(camera.fx_px, camera.fy_px));
  models_ = {axis_model(calibration, Axis::kColumn), axis_model(calibration, Axis::kRow)};
  extent_px_ = {calibration.projector.width, calibration.projector.height};
  std::size_t at = 0;
  for (int row = 0; row < rows_; ++row) {
    Vec2 bent = Vec2::Zero();  // by the lens, at the pixel to the left: shortens the search
    for (int col = 0; col < cols_; ++col, ++at) {
      const Vec2 seen((col - camera.cx_px) / camera.fx_px, (row - camera.cy_px) / camera.fy_px);
      const auto ideal = undistort(camera, seen, seen + bent);
      bent = ideal ? Vec2(*ideal - seen) : Vec2::Zero();
      constexpr double kNoRay = std::numeric_limits<double>::quiet_NaN();  // depth 0 follows
      ray_u_[at] = static_cast<float>(ideal ? ideal->x() : kNoRay);
      ray_v_[at] = static_cast<float>(ideal ? ideal->y() : kNoRay);
    }
  }
  return {};
}

void Triangulator::measure_axis(Axis axis, ImageView<float> code_px, int row) {
  AxisScratch& scratch = scratch_[static_cast<std::size_t>(axis)];
  if (code_px.empty()) {
    std::fill(scratch.depth_mm.begin(), scratch.depth_mm.end(), 0.0F);
    return;
  }
  const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_);
  depth_row(models_[static_cast<std::size_t>(axis)], &ray_u_[at], &ray_v_[at], code_px.row(row), cols_,
            scratch.depth_mm.data(), scratch.mm_per_px.data(), scratch.other_px.data());
}

void Triangulator::combine_row(const CodeImage& code, int row) {
  const std::array<const CodeNoise*, 2> noise = {&code.column_noise, &code.row_noise};
  const std::array<ImageView<float>, 2> coded = {code.column_px, code.row_px};
  std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_);
  for (int col = 0; col < cols_; ++col, ++at) {
    const auto c = static_cast<std::size_t>(col);
    point_mm_[at].setZero();
    sigma_mm_[at] = 0.0F;
    std::array<float, 2> sigma_px{}, sigma_mm{};
    std::size_t best = 2;
    bool measured = false;
    for (std::size_t a = 0; a < 2; ++a) {
      if (coded[a].empty() || std::isnan(coded[a](row, col))) continue;
      measured = true;
      sigma_px[a] = code_sigma_px(*noise[a], code.modulation(row, col), code.texture(row, col));
      sigma_mm[a] = sigma_px[a] * scratch_[a].mm_per_px[c];
      const bool lit = scratch_[a].other_px[c] > -kModelSlackPx - 0.5F &&
                       scratch_[a].other_px[c] < static_cast<float>(extent_px_[1 - a]) - 0.5F + kModelSlackPx;
      if (scratch_[a].depth_mm[c] > 0.0F && lit && (best == 2 || sigma_mm[a] < sigma_mm[best])) best = a;
    }
    if (best == 2) {
      counts_.outside_projector += measured ? 1 : 0;
      continue;
    }
    const std::size_t other = 1 - best;
    if (!coded[other].empty() && !std::isnan(coded[other](row, col))) {
      const float off_px = std::fabs(coded[other](row, col) - scratch_[best].other_px[c]);
      if (off_px > kModelSlackPx + kAgreeSigmas * (sigma_px[0] + sigma_px[1])) {
        ++counts_.axes_disagree;
        continue;
      }
    }
    const Vec3f ray(ray_u_[at], ray_v_[at], 1.0F);
    point_mm_[at] = scratch_[best].depth_mm[c] * ray;
    sigma_mm_[at] = sigma_mm[best] * ray.norm();
  }
}

Result<RangeImage> Triangulator::measure(const CodeImage& code) {
  if (code.state.rows != rows_ || code.state.cols != cols_) {
    return failure(ResultCode::kCalibrationMismatch,
                   "the calibration is of a camera image of %dx%d, the capture's images are %dx%d; use the calibration "
                   "of this camera and region",
                   cols_, rows_, code.state.cols, code.state.rows);
  }
  counts_ = {};
  for (int row = 0; row < rows_; ++row) {
    measure_axis(Axis::kColumn, code.column_px, row);
    measure_axis(Axis::kRow, code.row_px, row);
    combine_row(code, row);
  }
  const RangeImage range{{point_mm_.data(), rows_, cols_}, {sigma_mm_.data(), rows_, cols_}, code.texture};
  counts_.flying = edges_.apply(range, code.modulation, focal_px_);
  counts_.points = static_cast<int>(std::count_if(range.point_mm.data, range.point_mm.data + range.point_mm.size(),
                                                  [](const Vec3f& point) { return point.z() > 0.0F; }));
  return range;
}

}  // namespace beltpick::range
