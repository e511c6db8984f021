#include "pipeline/measured_normals.hpp"

#include <algorithm>
#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::pipeline {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

constexpr int kHalfWindow = 2;  // in strides
constexpr int kMostStride = 8;
constexpr float kLeastNeighbours = 7.0F;
constexpr float kLeastBreadth = 0.02F;  // of their spread, of that along the line they may lie on
constexpr int kTurnsToThinnest = 2;

constexpr std::size_t kLanes = PixelBlock::kSize;
using Lane = std::array<float, kLanes>;
using Index = PixelBlock::Row;

// The range image's plain numbers: x, y, z of each pixel.
struct Image {
  const float* point_mm;
  int rows, cols;
};

// How far apart neighbouring pixels see at each point, mm; 0 where neither neighbour was measured.
BELTPICK_INLINE void find_pitch(const Image& image, const Index& row, const Index& col, Lane& pitch_mm) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    const int here = row[k] * image.cols + col[k];
    const int left = col[k] > 0 ? here - 1 : here;
    const int right = col[k] < image.cols - 1 ? here + 1 : here;
    const float x = image.point_mm[3 * here];
    const float to_left = std::fabs(image.point_mm[3 * left] - x);
    const float to_right = std::fabs(image.point_mm[3 * right] - x);
    const bool has_left = (left != here) & (image.point_mm[3 * left + 2] > 0.0F);
    const bool has_right = (right != here) & (image.point_mm[3 * right + 2] > 0.0F);
    const float lesser = to_right < to_left ? to_right : to_left;
    const float either = has_left ? to_left : 0.0F;
    const float one = has_right ? to_right : either;
    pitch_mm[k] = has_left & has_right ? lesser : one;
  }
}

// Second moments of points about their mean; all zero where they are too few.
struct Spread {
  alignas(64) Lane xx{}, yy{}, zz{}, xy{}, xz{}, yz{};
};
struct Sums {
  alignas(64) Lane x{}, y{}, z{}, count{};
};

// Of the points on a lattice of pixels round each, those within reach of its point.
BELTPICK_INLINE void spread_round(const Image& image, const Index& row, const Index& col, const Index& stride,
                                  const Lane& reach2, Spread& s) {
  Sums sum;
  for (int down = -kHalfWindow; down <= kHalfWindow; ++down) {
    for (int across = -kHalfWindow; across <= kHalfWindow; ++across) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        const int here = 3 * (row[k] * image.cols + col[k]);
        const int r = row[k] + down * stride[k];
        const int c = col[k] + across * stride[k];
        const bool inside = (r >= 0) & (r < image.rows) & (c >= 0) & (c < image.cols);
        const int there = inside ? 3 * (r * image.cols + c) : here;
        const float ax = image.point_mm[there] - image.point_mm[here];
        const float ay = image.point_mm[there + 1] - image.point_mm[here + 1];
        const float z = image.point_mm[there + 2];
        const float az = z - image.point_mm[here + 2];
        const bool counts = inside & (z > 0.0F) & (ax * ax + ay * ay + az * az <= reach2[k]);
        const float dx = counts ? ax : 0.0F, dy = counts ? ay : 0.0F, dz = counts ? az : 0.0F;
        sum.x[k] += dx, sum.y[k] += dy, sum.z[k] += dz, sum.count[k] += counts ? 1.0F : 0.0F;
        s.xx[k] += dx * dx, s.yy[k] += dy * dy, s.zz[k] += dz * dz;
        s.xy[k] += dx * dy, s.xz[k] += dx * dz, s.yz[k] += dy * dz;
      }
    }
  }
  for (std::size_t k = 0; k < kLanes; ++k) {
    const bool enough = sum.count[k] >= kLeastNeighbours;
    const float per = enough ? 1.0F / sum.count[k] : 0.0F;
    const float x = sum.x[k] * per, y = sum.y[k] * per, z = sum.z[k] * per;
    s.xx[k] = s.xx[k] * per - x * x, s.yy[k] = s.yy[k] * per - y * y, s.zz[k] = s.zz[k] * per - z * z;
    s.xy[k] = s.xy[k] * per - x * y, s.xz[k] = s.xz[k] * per - x * z, s.yz[k] = s.yz[k] * per - y * z;
  }
}

struct Direction {
  float x, y, z;
};
BELTPICK_INLINE Direction normalised(const Direction& d) {
  const float square = d.x * d.x + d.y * d.y + d.z * d.z;
  const float per = square > 0.0F ? 1.0F / std::sqrt(square) : 0.0F;
  return {d.x * per, d.y * per, d.z * per};
}

// The direction in which points spread least; not found where they lie on a line. The matrix of cofactors is the
// inverse but for a factor: it turns any vector towards that direction, by some hundred times at once where points lie
// on a surface.
BELTPICK_INLINE void thinnest_direction(const Spread& s, NormalBlock& normals) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float xx = s.yy[k] * s.zz[k] - s.yz[k] * s.yz[k], yy = s.xx[k] * s.zz[k] - s.xz[k] * s.xz[k],
                zz = s.xx[k] * s.yy[k] - s.xy[k] * s.xy[k], xy = s.xz[k] * s.yz[k] - s.xy[k] * s.zz[k],
                xz = s.xy[k] * s.yz[k] - s.xz[k] * s.yy[k], yz = s.xy[k] * s.xz[k] - s.xx[k] * s.yz[k];
    // From the steepest column on.
    const bool first = (xx >= yy) & (xx >= zz), second = yy >= zz;
    Direction d{first ? xx : second ? xy : xz, first ? xy : second ? yy : yz, first ? xz : second ? yz : zz};
#pragma GCC unroll 2
    for (int turn = 0; turn < kTurnsToThinnest; ++turn) {
      d = normalised(d);
      d = {xx * d.x + xy * d.y + xz * d.z, xy * d.x + yy * d.y + yz * d.z, xz * d.x + yz * d.y + zz * d.z};
    }
    d = normalised(d);
    const float least = d.x * (s.xx[k] * d.x + s.xy[k] * d.y + s.xz[k] * d.z) +
                        d.y * (s.xy[k] * d.x + s.yy[k] * d.y + s.yz[k] * d.z) +
                        d.z * (s.xz[k] * d.x + s.yz[k] * d.y + s.zz[k] * d.z);
    // The other two eigenvalues, by their sum and product: of a ratio q the product is q / (1 + q)^2 of the sum's
    // square.
    const float sum = s.xx[k] + s.yy[k] + s.zz[k] - least, product = xx + yy + zz - least * sum;
    constexpr float kLeastOfSquare = kLeastBreadth / ((1.0F + kLeastBreadth) * (1.0F + kLeastBreadth));
    normals.x[k] = d.x, normals.y[k] = d.y, normals.z[k] = d.z;
    normals.found[k] = product > kLeastOfSquare * sum * sum ? 1 : 0;
  }
}

BELTPICK_KERNEL void find_normals(const Image& range, const PixelBlock& pixels, float radius_mm, NormalBlock& normals) {
  const Image image = range;
  alignas(64) const Index row = pixels.row, col = pixels.col;
  alignas(64) Index stride;
  alignas(64) Lane pitch_mm, reach2;
  find_pitch(image, row, col, pitch_mm);
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float strides = radius_mm / (kHalfWindow * std::max(pitch_mm[k], 1e-6F)) + 0.5F;
    stride[k] = std::max(static_cast<int>(std::min(strides, static_cast<float>(kMostStride))), 1);
    // Beyond the diagonal of the window on a surface leaning by 70 degrees there is a step.
    const float reach = 3.0F * 1.42F * pitch_mm[k] * static_cast<float>(stride[k] * kHalfWindow);
    reach2[k] = reach * reach;
  }
  Spread spread;
  spread_round(image, row, col, stride, reach2, spread);
  thinnest_direction(spread, normals);
  for (std::size_t k = 0; k < kLanes; ++k) {
    const int here = 3 * (row[k] * image.cols + col[k]);
    const float away = normals.x[k] * image.point_mm[here] + normals.y[k] * image.point_mm[here + 1] +
                       normals.z[k] * image.point_mm[here + 2];
    const float sign = away > 0.0F ? -1.0F : 1.0F;
    normals.x[k] *= sign, normals.y[k] *= sign, normals.z[k] *= sign;
    normals.found[k] = pitch_mm[k] > 0.0F ? normals.found[k] : 0;
  }
}

}  // namespace

void measured_normals(const RangeImage& range, const PixelBlock& pixels, float radius_mm, NormalBlock& normals) {
  if (pixels.count == 0) return;
  PixelBlock whole = pixels;  // filled up with its first pixel
  for (auto k = static_cast<std::size_t>(pixels.count); k < kLanes; ++k) {
    whole.row[k] = pixels.row[0], whole.col[k] = pixels.col[0];
  }
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  find_normals({range.point_mm.data->data(), range.point_mm.rows, range.point_mm.cols}, whole, radius_mm, normals);
}

std::optional<Vec3f> measured_normal(const RangeImage& range, int row, int col, float radius_mm) {
  PixelBlock pixel;
  pixel.add(row, col);
  NormalBlock normal;
  measured_normals(range, pixel, radius_mm, normal);
  if (normal.found[0] == 0) return {};
  return normal.at(0);
}

}  // namespace beltpick::pipeline
