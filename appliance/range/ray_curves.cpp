#include "range/ray_curves.hpp"

#include "range/curve_kernel.hpp"
#include "range/lens_model.hpp"

namespace beltpick::range {

RayCurves::RayCurves(Arena& arena, int rows, int cols) {
  const auto across = static_cast<std::size_t>(corners_along(cols));
  for (Coordinate& coordinate : coordinates_) {
    coordinate.corners = arena.take<float>("camera rays", across * static_cast<std::size_t>(rows));
    coordinate.slope = arena.take<float>("camera rays", across);
    coordinate.bend = arena.take<float>("camera rays", across);
  }
}

bool RayCurves::load(const Lens& camera) {
  across_ = corners_along(camera.width);
  std::size_t at = 0;
  for (int row = 0; row < camera.height; ++row) {
    Vec2 bent = Vec2::Zero();  // by the lens, at the corner to the left: shortens the search
    for (int corner = 0; corner < across_; ++corner, ++at) {
      const Vec2 seen(((corner - 1) * kBlock - camera.cx_px) / camera.fx_px, (row - camera.cy_px) / camera.fy_px);
      const auto ideal = undistort(camera, seen, seen + bent);
      if (!ideal) return false;
      bent = *ideal - seen;
      coordinates_[0].corners[at] = static_cast<float>(ideal->x());
      coordinates_[1].corners[at] = static_cast<float>(ideal->y());
    }
  }
  return true;
}

RayRow RayCurves::row(int row) {
  std::array<RayCurve, 2> curves{};
  for (std::size_t c = 0; c < 2; ++c) {
    Coordinate& own = coordinates_[c];
    const float* corners = &own.corners[static_cast<std::size_t>(row) * static_cast<std::size_t>(across_)];
    parabolas_through(corners, across_ - 3, own.slope.data(), own.bend.data());
    curves[c] = {corners + 1, own.slope.data(), own.bend.data()};
  }
  return {curves[0], curves[1]};
}

}  // namespace beltpick::range
