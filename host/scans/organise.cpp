#include "scans/organise.hpp"

#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"

namespace beltpick::scans {
namespace {

constexpr std::size_t kLeastPoints = 500;
constexpr int kMostPixels = 4'000'000;
// Pixels a little wider than the points lie apart leave few gaps.
constexpr double kPixelSpacings = 1.15;

struct Extent {
  double low_x = 1e9, high_x = -1e9, low_y = 1e9, high_y = -1e9;  // x / z, y / z
};

// How far apart neighbouring points see, as a tangent: from how many cells of a first lattice they fill.
double spacing(const Mesh& cloud, const Extent& extent) {
  const double area = (extent.high_x - extent.low_x) * (extent.high_y - extent.low_y);
  // The finest lattice that they fill well: halve the cells until they leave gaps.
  double cell = std::sqrt(area / 400.0);
  double last_filled = 0.0;
  for (int halving = 0; halving < 12; ++halving) {
    const auto cols = static_cast<std::size_t>((extent.high_x - extent.low_x) / cell) + 1;
    const auto rows = static_cast<std::size_t>((extent.high_y - extent.low_y) / cell) + 1;
    std::vector<bool> filled(cols * rows, false);
    for (const Vec3f& p : cloud.vertex_mm) {
      const double x = static_cast<double>(p.x() / p.z()) - extent.low_x;
      const double y = static_cast<double>(p.y() / p.z()) - extent.low_y;
      filled[static_cast<std::size_t>(y / cell) * cols + static_cast<std::size_t>(x / cell)] = true;
    }
    const double share = cell * cell * static_cast<double>(std::count(filled.begin(), filled.end(), true));
    // Twice as fine a lattice fills the same area as long as every cell holds a point.
    if (halving > 0 && share < 0.8 * last_filled) break;
    last_filled = share;
    cell /= std::sqrt(2.0);
  }
  return std::sqrt(last_filled / static_cast<double>(cloud.vertex_mm.size()));
}

}  // namespace

Result<Organised> organise(const Mesh& cloud, const std::string& name) {
  if (cloud.vertex_mm.size() < kLeastPoints) {
    return failure(ResultCode::kTooFewPoints, "%s: expected a scan of at least %zu points, found %zu", name.c_str(),
                   kLeastPoints, cloud.vertex_mm.size());
  }
  Extent extent;
  for (const Vec3f& p : cloud.vertex_mm) {
    if (!(p.z() > 0.0F)) {
      return failure(ResultCode::kFormatInvalid,
                     "%s: expected points in the frame of the camera that took them (z > 0, away from it), found z = "
                     "%.3g; several scans are told apart by where they were taken from: export the single scans",
                     name.c_str(), static_cast<double>(p.z()));
    }
    const double x = static_cast<double>(p.x() / p.z());
    const double y = static_cast<double>(p.y() / p.z());
    extent = {std::min(extent.low_x, x), std::max(extent.high_x, x), std::min(extent.low_y, y),
              std::max(extent.high_y, y)};
  }
  Organised image;
  const double area = (extent.high_x - extent.low_x) * (extent.high_y - extent.low_y);
  const double pixel = std::max(kPixelSpacings * spacing(cloud, extent), std::sqrt(area / kMostPixels));
  constexpr int kMargin = 4;
  image.cols = static_cast<int>((extent.high_x - extent.low_x) / pixel) + 1 + 2 * kMargin;
  image.rows = static_cast<int>((extent.high_y - extent.low_y) / pixel) + 1 + 2 * kMargin;
  image.lens = {image.cols,
                image.rows,
                1.0 / pixel,
                1.0 / pixel,
                kMargin - 0.5 - extent.low_x / pixel,
                kMargin - 0.5 - extent.low_y / pixel};
  image.point_mm.assign(static_cast<std::size_t>(image.rows) * static_cast<std::size_t>(image.cols), Vec3f::Zero());
  for (const Vec3f& p : cloud.vertex_mm) {
    const auto col = static_cast<std::size_t>((static_cast<double>(p.x() / p.z()) - extent.low_x) / pixel) + kMargin;
    const auto row = static_cast<std::size_t>((static_cast<double>(p.y() / p.z()) - extent.low_y) / pixel) + kMargin;
    Vec3f& held = image.point_mm[row * static_cast<std::size_t>(image.cols) + col];
    if (!(held.z() > 0.0F) || p.z() < held.z()) held = p;
  }
  return image;
}

}  // namespace beltpick::scans
