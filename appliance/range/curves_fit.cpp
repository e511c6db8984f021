#include "range/curves_fit.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::range {
namespace {

constexpr int kPixels = 16 * kBlock;  // tried at a time
constexpr int kCodes = 12;
constexpr int kTriedRowsApart = 50;
constexpr float kNearPx = 0.006F;  // what floats resolve, and a small part of the noise of any sequence
constexpr float kFarMm = 1e5F;     // no cell is that large
// The curves' other coordinate leaves out what shifts it by less than the slack; there both may be right.
constexpr float kBorderPx = 0.5F * kModelSlackPx;

struct Pixels {
  std::array<float, kPixels> code_px{}, modulation{}, mm{}, per_px{}, other_px{}, sigma_px{};
  std::array<std::uint8_t, kPixels> texture{};
};

// A run of pixels of one image row.
struct Run {
  const float *ray_u, *ray_v;
  int count;
};

// With a noise of one pixel and no other, the standard deviation is what a pixel of code is worth in mm.
AxisInput input_of(const Run& run, const Pixels& pixels) {
  return {run.ray_u,
          run.ray_v,
          pixels.code_px.data(),
          pixels.modulation.data(),
          pixels.texture.data(),
          CodeNoise{.floor_px = 1.0F, .slope_px = 0.0F}};
}

bool same_depths(const AxisModel& model, const Run& run, const CurveRow& curves, float code_px) {
  Pixels exact;
  Pixels curved;
  exact.code_px.fill(code_px);
  depth_row(model, input_of(run, exact), run.count, exact.mm.data(), exact.per_px.data(), exact.other_px.data(),
            exact.sigma_px.data());
  depth_row(curves, input_of(run, exact), run.count, curved.mm.data(), curved.per_px.data());
  for (int i = 0; i < run.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (std::isnan(run.ray_u[i])) return false;
    const float inside_px =
        std::min(exact.other_px[at] - curves.first_other_px, curves.last_other_px - exact.other_px[at]);
    if (std::fabs(inside_px) < kBorderPx) continue;
    const bool is_near = exact.mm[at] > 0.0F && exact.mm[at] < kFarMm;
    if (!is_near && (curved.mm[at] == 0.0F || curved.mm[at] > 0.5F * kFarMm)) continue;
    if (!(std::fabs(exact.mm[at] - curved.mm[at]) <= kNearPx * exact.per_px[at])) return false;
  }
  return true;
}

}  // namespace

bool curves_fit(const AxisModel& model, int extent_px, DepthCurves& curves, std::span<const float> ray_u,
                std::span<const float> ray_v, int cols) {
  const int rows = static_cast<int>(ray_u.size()) / cols;
  for (int row = 0; row < rows; row += kTriedRowsApart) {
    CurveRow across = curves.row(row);
    for (int first = 0; first < cols; first += kPixels) {
      const std::size_t at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(first);
      const Run run{&ray_u[at], &ray_v[at], std::min(kPixels, cols - first)};
      for (int c = 0; c < kCodes; ++c) {
        const float code_px = static_cast<float>(c) * static_cast<float>(extent_px - 1) / (kCodes - 1);
        if (!same_depths(model, run, across, code_px)) return false;
      }
      across.at += kPixels / kBlock;
      across.slope += kPixels / kBlock;
      across.bend += kPixels / kBlock;
    }
  }
  return true;
}

}  // namespace beltpick::range
