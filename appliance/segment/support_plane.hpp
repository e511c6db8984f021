// The plane that carries the objects: belt, table or floor.
#pragma once

#include <optional>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"
#include "segment/scale.hpp"

namespace beltpick::segment {

struct SupportPlane {
  Plane plane;
  double spread_mm = 0.0;  // robust standard deviation of the carrying surface about it: noise, bend, texture
};

class SupportPlaneFinder {
 public:
  explicit SupportPlaneFinder(Arena& arena);

  // The plane with the most points by MSAC, or one parallel to it farther away that has still a good share of them: the
  // belt rather than the lid of a large box on it. Nothing where no plane holds a tenth of what was measured, or more
  // was seen behind it than on it.
  // Deterministic.
  std::optional<SupportPlane> find(const RangeImage& range, const Scale& scale);

  // How the surface lies about a plane that is known.
  SupportPlane measure(const RangeImage& range, const Scale& scale, const Plane& plane);

 private:
  void sample(const RangeImage& range);
  std::optional<Plane> best_plane(const Scale& scale, const Plane* above);
  [[nodiscard]] Plane refined(Plane plane, const Scale& scale) const;
  [[nodiscard]] double spread_mm(const Plane& plane, const Scale& scale);
  [[nodiscard]] int inliers(const Plane& plane, const Scale& scale) const;
  [[nodiscard]] int behind(const Plane& plane, const Scale& scale) const;

  std::span<Vec3f> points_;
  std::span<float> residuals_;
  std::size_t count_ = 0;
};

}  // namespace beltpick::segment
