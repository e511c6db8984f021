#include "range/triangulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contract/result_codes.hpp"
#include "range/lens_model.hpp"

namespace beltpick::range {
namespace {

// How far, in projector pixels, codes may stand from where the geometry puts them: calibration error and lens residue.
constexpr float kModelSlackPx = 3.0F;
constexpr float kAgreeSigmas = 5.0F;

ImageView<float> codes_of(const CodeImage& code, Axis axis) {
  return axis == Axis::kColumn ? code.column_px : code.row_px;
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
    scratch.sigma_px = arena.take<float>("range scratch", static_cast<std::size_t>(cols));
    scratch.sigma_mm = arena.take<float>("range scratch", static_cast<std::size_t>(cols));
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

void Triangulator::measure_axis(Axis axis, const CodeImage& code, int row) {
  const auto a = static_cast<std::size_t>(axis);
  AxisScratch& scratch = scratch_[a];
  const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_);
  depth_row(models_[a], &ray_u_[at], &ray_v_[at], codes_of(code, axis).row(row), cols_, scratch.depth_mm.data(),
            scratch.mm_per_px.data(), scratch.other_px.data());
  judge_row(axis == Axis::kColumn ? code.column_noise : code.row_noise, code.modulation.row(row), code.texture.row(row),
            scratch.mm_per_px.data(), scratch.other_px.data(), extent_px_[1 - a], kModelSlackPx, cols_,
            scratch.depth_mm.data(), scratch.sigma_px.data(), scratch.sigma_mm.data());
}

void Triangulator::choose_axis(const CodeImage& code, int row) {
  AxisScratch& column = scratch_[0];
  const AxisScratch& rows = scratch_[1];
  for (int col = 0; col < cols_; ++col) {
    const auto c = static_cast<std::size_t>(col);
    const bool from_columns = column.depth_mm[c] > 0.0F;
    const bool from_rows = rows.depth_mm[c] > 0.0F;
    const bool prefer_rows = from_rows && (!from_columns || rows.sigma_mm[c] < column.sigma_mm[c]);
    const float told_px = prefer_rows ? code.column_px(row, col) : code.row_px(row, col);
    const float expected_px = prefer_rows ? rows.other_px[c] : column.other_px[c];
    const float most_px = kModelSlackPx + kAgreeSigmas * (column.sigma_px[c] + rows.sigma_px[c]);
    // Where the other axis has no code, told_px is NaN and contradicts nothing.
    const bool contrary = (from_columns || from_rows) && std::fabs(told_px - expected_px) > most_px;
    if (prefer_rows) {
      column.depth_mm[c] = rows.depth_mm[c];
      column.sigma_mm[c] = rows.sigma_mm[c];
    }
    if (contrary) column.depth_mm[c] = 0.0F;
    counts_.axes_disagree += contrary ? 1 : 0;
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
  const bool columns = !code.column_px.empty();
  const bool rows = !code.row_px.empty();
  for (int row = 0; row < rows_; ++row) {
    if (columns) measure_axis(Axis::kColumn, code, row);
    if (rows) measure_axis(Axis::kRow, code, row);
    if (columns && rows) choose_axis(code, row);
    const AxisScratch& chosen = scratch_[columns ? 0 : 1];
    const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_);
    counts_.points += point_row(&ray_u_[at], &ray_v_[at], chosen.depth_mm.data(), chosen.sigma_mm.data(), cols_,
                                point_mm_[at].data(), &sigma_mm_[at]);
  }
  const auto coded =
      static_cast<int>(std::count(code.state.data, code.state.data + code.state.size(), PixelState::kValid));
  counts_.outside_projector = coded - counts_.points - counts_.axes_disagree;
  const RangeImage range{{point_mm_.data(), rows_, cols_}, {sigma_mm_.data(), rows_, cols_}, code.texture};
  counts_.flying = edges_.apply(range, code.modulation, focal_px_);
  counts_.points -= counts_.flying;
  return range;
}

}  // namespace beltpick::range
