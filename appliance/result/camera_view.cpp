#include "result/camera_view.hpp"

#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::result {
namespace {

constexpr float kFacing = 0.02F;  // cosine from which on a surface faces the camera

BELTPICK_KERNEL void look_at_steps(const PointBlock& at, const Optics& o, float spacing_mm, std::size_t count,
                                   Seen& __restrict seen) {
  for (std::size_t i = 0; i < count; i += PointBlock::kLanes) {
    for (std::size_t k = i; k < i + PointBlock::kLanes; ++k) {
      const float away = -(at.nx[k] * at.x[k] + at.ny[k] * at.y[k] + at.nz[k] * at.z[k]);
      const float distance = std::sqrt(at.x[k] * at.x[k] + at.y[k] * at.y[k] + at.z[k] * at.z[k]);
      const float cosine = away / distance;
      const float x = at.x[k] / at.z[k], y = at.y[k] / at.z[k];
      const float straight_column = o.fx * x + o.cx, straight_row = o.fy * y + o.cy;
      const float r2 = x * x + y * y;
      const float radial = 1.0F + r2 * (o.k1 + r2 * (o.k2 + r2 * o.k3));
      seen.column_px[k] = o.fx * (x * radial + 2.0F * o.p1 * x * y + o.p2 * (r2 + 2.0F * x * x)) + o.cx;
      seen.row_px[k] = o.fy * (y * radial + o.p1 * (r2 + 2.0F * y * y) + 2.0F * o.p2 * x * y) + o.cy;
      seen.cosine[k] = cosine;
      const float sine2 = 1.0F - cosine * cosine;
      seen.own_mm[k] = spacing_mm * (1.0F + 2.0F * std::sqrt(sine2 > 0.0F ? sine2 : 0.0F) / cosine);
      seen.facing[k] = (at.z[k] > 1.0F ? 1 : 0) & (cosine > kFacing ? 1 : 0) & (straight_column > o.left ? 1 : 0) &
                       (straight_column < o.right ? 1 : 0) & (straight_row > o.top ? 1 : 0) &
                       (straight_row < o.bottom ? 1 : 0);
    }
  }
}

}  // namespace

Optics::Optics(const Lens& lens)
    : fx(static_cast<float>(lens.fx_px)),
      fy(static_cast<float>(lens.fy_px)),
      cx(static_cast<float>(lens.cx_px)),
      cy(static_cast<float>(lens.cy_px)),
      k1(static_cast<float>(lens.distortion[0])),
      k2(static_cast<float>(lens.distortion[1])),
      p1(static_cast<float>(lens.distortion[2])),
      p2(static_cast<float>(lens.distortion[3])),
      k3(static_cast<float>(lens.distortion[4])),
      left(-0.25F * static_cast<float>(lens.width)),
      right(1.25F * static_cast<float>(lens.width)),
      top(-0.25F * static_cast<float>(lens.height)),
      bottom(1.25F * static_cast<float>(lens.height)) {}

void look_at(const PointBlock& at_camera, const Optics& optics, float spacing_mm, int count, Seen& seen) {
  look_at_steps(at_camera, optics, spacing_mm, static_cast<std::size_t>(PointBlock::whole_steps(count)), seen);
}

}  // namespace beltpick::result
