#include "range/triangulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contract/result_codes.hpp"
#include "range/curves_fit.hpp"
#include "range/lens_model.hpp"
#include "range/lens_strength.hpp"
#include "range/stream_copy.hpp"

namespace beltpick::range {
namespace {

constexpr float kAgreeSigmas = 5.0F;

}  // namespace

Triangulator::Triangulator(Arena& arena, int rows, int cols)
    : max_rows_(rows),
      max_cols_(cols),
      edges_(arena, cols),
      curves_{DepthCurves(arena, rows, cols), DepthCurves(arena, rows, cols)},
      rays_(arena, rows, cols) {
  const std::size_t pixels = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  const auto width = static_cast<std::size_t>(cols);
  const auto whole_blocks = static_cast<std::size_t>(blocks_along(cols) * kBlock);
  ray_u_ = arena.take<float>("camera rays", pixels + kBlock);  // rows are read in whole blocks
  ray_v_ = arena.take<float>("camera rays", pixels + kBlock);
  point_mm_ = arena.take<Vec3f>("range image", pixels);
  sigma_mm_ = arena.take<float>("range image", pixels);
  for (AxisScratch& scratch : scratch_) {
    scratch.depth_mm = arena.take<float>("range scratch", width);
    scratch.sigma_mm = arena.take<float>("range scratch", width);
    scratch.other_px = arena.take<float>("range scratch", width);
    scratch.sigma_px = arena.take<float>("range scratch", width);
  }
  for (DepthRow& row : depths_) {
    row.depth_mm = arena.take<float>("range scratch", whole_blocks);
    row.sigma_mm = arena.take<float>("range scratch", whole_blocks);
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
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    const Lens& projector = calibration.projector;
    AxisModel& model = models_[static_cast<std::size_t>(axis)] = axis_model(calibration, axis);
    const int extent_px = axis == Axis::kColumn ? projector.width : projector.height;
    model.strong_lens = !one_step_suffices(model, extent_px, ray_u_.first(at), ray_v_.first(at));
    DepthCurves& curves = curves_[static_cast<std::size_t>(axis)];
    curves.load(calibration, axis);
    by_curves_[static_cast<std::size_t>(axis)] =
        curves_fit(model, extent_px, curves, ray_u_.first(at), ray_v_.first(at), cols_);
  }
  rays_by_curves_ = rays_.load(camera) && (by_curves_[0] || by_curves_[1]);
  return {};
}

AxisInput Triangulator::input(Axis axis, const CodeImage& band, int band_row, int row) const {
  const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_);
  const bool column = axis == Axis::kColumn;
  return {&ray_u_[at],
          &ray_v_[at],
          (column ? band.column_px : band.row_px).row(band_row),
          band.modulation.row(band_row),
          band.texture.row(band_row),
          column ? band.column_noise : band.row_noise};
}

void Triangulator::measure_both(const CodeImage& band, int band_row, int row, const DepthRow& out) {
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    const auto a = static_cast<std::size_t>(axis);
    const AxisScratch& scratch = scratch_[a];
    depth_row(models_[a], input(axis, band, band_row, row), cols_, scratch.depth_mm.data(), scratch.sigma_mm.data(),
              scratch.other_px.data(), scratch.sigma_px.data());
  }
  const AxisScratch& columns = scratch_[0];
  const AxisScratch& rows = scratch_[1];
  for (int col = 0; col < cols_; ++col) {
    const auto c = static_cast<std::size_t>(col);
    const bool from_columns = columns.depth_mm[c] > 0.0F;
    const bool from_rows = rows.depth_mm[c] > 0.0F;
    const bool prefer_rows = from_rows && (!from_columns || rows.sigma_mm[c] < columns.sigma_mm[c]);
    const float told_px = prefer_rows ? band.column_px(band_row, col) : band.row_px(band_row, col);
    const float expected_px = prefer_rows ? rows.other_px[c] : columns.other_px[c];
    const float most_px = kModelSlackPx + kAgreeSigmas * (columns.sigma_px[c] + rows.sigma_px[c]);
    // Where the other axis has no code, told_px is NaN and contradicts nothing.
    const bool contrary = (from_columns || from_rows) && std::fabs(told_px - expected_px) > most_px;
    out.depth_mm[c] = contrary ? 0.0F : prefer_rows ? rows.depth_mm[c] : columns.depth_mm[c];
    out.sigma_mm[c] = prefer_rows ? rows.sigma_mm[c] : columns.sigma_mm[c];
    counts_.axes_disagree += contrary ? 1 : 0;
  }
}

void Triangulator::measure_row(const CodeImage& band, int band_row, int row) {
  const DepthRow& out = depths_of(row);
  const bool columns = !band.column_px.empty();
  const Axis axis = columns ? Axis::kColumn : Axis::kRow;
  const auto a = static_cast<std::size_t>(axis);
  if (columns && !band.row_px.empty()) {
    measure_both(band, band_row, row, out);
  } else if (by_curves_[a]) {
    // The points that wait are written meanwhile.
    depth_row(curves_[a].row(row), input(axis, band, band_row, row), cols_, out.depth_mm.data(), out.sigma_mm.data(),
              waiting_.depth_mm != nullptr ? &waiting_ : nullptr);
    waiting_ = {};
  } else {
    depth_row(models_[a], input(axis, band, band_row, row), cols_, out.depth_mm.data(), out.sigma_mm.data());
  }
  write_waiting();
  const auto flies = edges_.push(out.depth_mm.data(), out.sigma_mm.data(), band.modulation.row(band_row));
  if (row > 0) settle(row - 1, flies);
  if (row < rows_ - 1) return;
  write_waiting();
  settle(row, edges_.last());
  write_waiting();
}

void Triangulator::settle(int row, std::span<const std::uint8_t> flies) {
  const DepthRow& depths = depths_of(row);
  const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_);
  const RowCounts counted = settle_row(depths.depth_mm.data(), flies.data(), state_.row(row), cols_);
  counts_.points += counted.points;
  counts_.flying += counted.flying;
  counts_.outside_projector += counted.coded - counted.points - counted.flying;
  waiting_ = {rays_by_curves_ ? rays_.row(row) : RayRow{.u = &ray_u_[at], .v = &ray_v_[at]}, depths.depth_mm.data(),
              depths.sigma_mm.data(), point_mm_[at].data(), &sigma_mm_[at]};
}

void Triangulator::write_waiting() {
  if (waiting_.depth_mm != nullptr) write_points(waiting_, cols_);
  waiting_ = {};
}

Result<RangeImage> Triangulator::begin(const CodeImage& code) {
  if (code.state.rows != rows_ || code.state.cols != cols_) {
    return failure(ResultCode::kCalibrationMismatch,
                   "the calibration is of a camera image of %dx%d, the capture's images are %dx%d; use the calibration "
                   "of this camera and region",
                   cols_, rows_, code.state.cols, code.state.rows);
  }
  state_ = code.state;
  counts_ = {};
  waiting_ = {};
  edges_.begin(cols_, focal_px_);
  return RangeImage{{point_mm_.data(), rows_, cols_}, {sigma_mm_.data(), rows_, cols_}, code.texture};
}

void Triangulator::measure_rows(const CodeImage& band, int first) {
  for (int row = 0; row < band.state.rows; ++row) measure_row(band, row, first + row);
  if (first + band.state.rows < rows_) return;
  stream_end();
  counts_.outside_projector -= counts_.axes_disagree;
}

Result<RangeImage> Triangulator::measure(const CodeImage& code) {
  auto range = begin(code);
  if (range) measure_rows(code, 0);
  return range;
}

}  // namespace beltpick::range
