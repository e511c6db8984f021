#include "teach/demands.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::teach {

namespace {

// More than the greatest support that misled.
constexpr double kSupportMargin = 0.05;
// Of parts that are 60 % in view, the projector's shadows leave so much and hardly less.
constexpr double kMostSupport = 0.35;
// Rough metal and a worn part may leave so many times what the simulated noise does; a surface tolerance has four
// standard deviations, so that less than a fifth of it is noise alone.
constexpr double kResidualMargin = 3.0;
constexpr double kLeastResidual = 0.2;
constexpr int kEnoughRight = 4;

// The pixel column or row before which `share` of the part's points lie.
int border_of(const SimulatedView& view, double share, bool across) {
  std::vector<float> at_px;
  at_px.reserve(view.of_part.size());
  for (const OrientedPoint& point : view.of_part) {
    const Vec3f& p = point.point_mm;
    at_px.push_back(across ? p.x() / p.z() * static_cast<float>(view.lens.fx_px) + static_cast<float>(view.lens.cx_px)
                           : p.y() / p.z() * static_cast<float>(view.lens.fy_px) + static_cast<float>(view.lens.cy_px));
  }
  const auto middle = at_px.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(at_px.size() - 1));
  std::nth_element(at_px.begin(), middle, at_px.end());
  return static_cast<int>(std::lround(*middle));
}

}  // namespace

pipeline::View cut(SimulatedView& view, double share, CutSide side) {
  const bool across = side == CutSide::kLeft || side == CutSide::kRight;
  const bool first_kept = side == CutSide::kRight || side == CutSide::kBottom;
  int from_row = 0, from_col = 0, rows = view.rows, cols = view.cols;
  if (!view.of_part.empty()) {
    const int border = border_of(view, first_kept ? share : 1.0 - share, across);
    int& extent = across ? cols : rows;
    int& from = across ? from_col : from_row;
    from = first_kept ? 0 : std::clamp(border, 0, extent - 1);
    extent = first_kept ? std::clamp(border, 1, extent) : extent - from;
  }
  pipeline::View input;
  input.range.point_mm =
      ImageView<Vec3f>(view.point_mm.data() + from_row * view.cols + from_col, rows, cols, view.cols);
  input.lens = view.lens;
  input.lens.width = cols;
  input.lens.height = rows;
  input.lens.cx_px -= from_col;
  input.lens.cy_px -= from_row;
  input.projector_mm = view.projector_mm;
  return input;
}

void Demands::believed(double support, double residual, bool wrong) {
  if (wrong) {
    ++wrong_;
    wrong_support_ = std::max(wrong_support_, support);
  } else {
    ++right_;
    right_residual_ = std::max(right_residual_, residual);
  }
}

Requirements Demands::derived() const {
  Requirements demands;
  if (wrong_ > 0) demands.support = std::clamp(wrong_support_ + kSupportMargin, demands.support, kMostSupport);
  if (right_ >= kEnoughRight)
    demands.residual = std::clamp(kResidualMargin * right_residual_, kLeastResidual, demands.residual);
  return demands;
}

}  // namespace beltpick::teach
