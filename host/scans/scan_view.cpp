#include "scans/scan_view.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/measured_normals.hpp"
#include "pipeline/noise.hpp"

namespace beltpick::scans {
namespace {

constexpr double kMostPoints = 26000.0;
constexpr std::size_t kLeastPoints = 300;
constexpr double kNormalRadiusMax_mm = 1.2;
constexpr double kNormalRadiusShare = 0.01;  // of the part's size
// A surface that leans away more than this is measured too poorly to build on.
constexpr float kLeastFacing = 0.17F;
constexpr int kGridCells = 2'000'000;
constexpr double kGridMarginShare = 0.06;

struct Box {
  Vec3f low = Vec3f::Constant(1e9F), high = Vec3f::Constant(-1e9F);
  void add(const Vec3f& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
};

template <class T>
void shuffle_alike(std::vector<OrientedPoint>& points, std::vector<T>& other) {
  Random random(points.size());
  for (std::size_t i = points.size() - 1; i > 0; --i) {
    const std::size_t j = random.below(static_cast<std::uint32_t>(i + 1));
    std::swap(points[i], points[j]);
    std::swap(other[i], other[j]);
  }
}

// The median distance between horizontal neighbours of the part.
double pixel_mm(const ScanSource& source, const CutOut& part) {
  std::vector<float> steps;
  for (int row = part.row_min; row <= part.row_max; row += 4) {
    for (int col = part.col_min; col < part.col_max; col += 4) {
      if (!part.holds(source.labels(row, col)) || !source.range.valid(row, col + 1)) continue;
      steps.push_back(std::abs(source.range.point_mm(row, col + 1).x() - source.range.point_mm(row, col).x()));
    }
  }
  if (steps.empty()) return 0.3;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return std::max(1e-3, static_cast<double>(*middle));
}

void build_grid(ScanView& view, const Box& box) {
  const GridShape shape =
      plan_closest_point_grid(box.low.cast<double>(), box.high.cast<double>(), kGridMarginShare * view.diagonal_mm,
                              0.7 * view.spacing_mm, kGridCells);
  view.grid_cells.resize(shape.count());
  view.grid.build(shape, view.point, view.grid_cells);
}

}  // namespace

Result<ScanView> make_view(const ScanSource& source, const CutOut& part) {
  ScanView view;
  view.name = source.name;
  view.belt = source.belt;
  view.cut = part.touches_border;
  view.noise_mm = pipeline::measurement_noise_mm(source.range, source.labels);
  Box box;
  for (int row = part.row_min; row <= part.row_max; ++row) {
    for (int col = part.col_min; col <= part.col_max; ++col) {
      if (part.holds(source.labels(row, col))) box.add(source.range.point_mm(row, col));
    }
  }
  view.diagonal_mm = static_cast<double>((box.high - box.low).norm());
  const auto radius = static_cast<float>(std::clamp(kNormalRadiusShare * view.diagonal_mm, 0.3, kNormalRadiusMax_mm));
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(part.pixels / kMostPoints))));
  for (int row = part.row_min; row <= part.row_max; row += stride) {
    for (int col = part.col_min; col <= part.col_max; col += stride) {
      if (!part.holds(source.labels(row, col))) continue;
      const Vec3f& point = source.range.point_mm(row, col);
      const auto normal = pipeline::measured_normal(source.range, row, col, radius);
      if (!normal || -normal->dot(point.normalized()) < kLeastFacing) continue;
      view.point.push_back({point, *normal});
      const auto typical = static_cast<float>(view.noise_mm);
      view.sigma_mm.push_back(source.range.sigma_mm.empty() ? typical
                                                            : std::max(0.02F, source.range.sigma_mm(row, col)));
    }
  }
  if (view.point.size() < kLeastPoints) {
    return failure(ResultCode::kTooFewPoints,
                   "%s: expected some %zu measured points on the part, found %zu; scan it nearer or better exposed",
                   source.name.c_str(), kLeastPoints, view.point.size());
  }
  shuffle_alike(view.point, view.sigma_mm);
  const double pixel = pixel_mm(source, part);
  view.spacing_mm = stride * pixel;
  view.seen = FreeSpace(source.range, source.lens, pixel);
  build_grid(view, box);
  return view;
}

}  // namespace beltpick::scans
