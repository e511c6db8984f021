#include "teach/recognition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "base/units.hpp"
#include "teach/cones.hpp"

namespace beltpick::teach {

namespace {

// Least shares of an object's points by which the appliance takes a primitive for found.
constexpr double kCurvedEnough = 0.12;
constexpr double kFaceEnough = 0.2;
constexpr double kNowAndThen = 0.05;
constexpr double kGrazing = 0.2;  // cosine: a surface that leans away farther is hardly measured
// The appliance's own steps, and its views over the sphere.
constexpr double kTurn_rad = rad_from_deg(15.0);
constexpr double kShiftShare = 0.035;
constexpr double kViews = 162;
constexpr double kPlaneShifts = 25;

bool curved(const Primitive& primitive) { return primitive.kind != PrimitiveKind::kPlane; }

int freedoms_left(const Primitive& primitive) { return primitive.kind == PrimitiveKind::kCylinder ? 2 : 3; }

bool mistakable(const Primitive& a, const Primitive& b) {
  if (a.kind != b.kind || a.concave != b.concave) return false;
  return !curved(a) || std::abs(a.radius_mm - b.radius_mm) < 0.5 + 0.05 * a.radius_mm;
}

int poses_of(const Primitive& primitive, const PartTemplate& part, const SearchSteps& steps) {
  const double diagonal_mm = (part.box_max_mm - part.box_min_mm).norm();
  const double turns = std::ceil(2 * kPi / (steps.turn_rad > 0 ? steps.turn_rad : kTurn_rad));
  const double shift_mm = steps.shift_mm > 0 ? steps.shift_mm : kShiftShare * diagonal_mm;
  switch (primitive.kind) {
    case PrimitiveKind::kCylinder:
      return static_cast<int>(2 * turns * (2 * std::ceil(0.5 * primitive.extent_mm / shift_mm) + 1));
    case PrimitiveKind::kPlane:
      return static_cast<int>(turns * kPlaneShifts);
    case PrimitiveKind::kSphere:
      return static_cast<int>(kViews * turns);
  }
  return 0;
}

}  // namespace

std::vector<bool> seen_along(const Surface& surface, const Vec3& direction) {
  const Vec3f z = direction.cast<float>();
  const Vec3f u = z.unitOrthogonal();
  const Vec3f v = z.cross(u);
  const auto cell_mm = static_cast<float>(1.6 * surface.spacing_mm);
  std::unordered_map<std::uint64_t, float> nearest;
  const auto cell_of = [&](const Vec3f& p) {
    const auto x = static_cast<std::int64_t>(std::floor(p.dot(u) / cell_mm));
    const auto y = static_cast<std::int64_t>(std::floor(p.dot(v) / cell_mm));
    return static_cast<std::uint64_t>(x + (1 << 30)) << 32U | static_cast<std::uint64_t>(y + (1 << 30));
  };
  for (std::size_t i = 0; i < surface.point_mm.size(); ++i) {
    if (surface.normal[i].dot(z) > 0.0F) continue;
    const float depth = surface.point_mm[i].dot(z);
    const auto [at, fresh] = nearest.try_emplace(cell_of(surface.point_mm[i]), depth);
    if (!fresh) at->second = std::min(at->second, depth);
  }
  std::vector<bool> seen(surface.point_mm.size(), false);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const float facing = -surface.normal[i].dot(z);
    if (facing < static_cast<float>(kGrazing)) continue;
    // Within a cell a leaning surface spreads over some depth of its own.
    const float slack = 2.0F * cell_mm / facing;
    seen[i] = surface.point_mm[i].dot(z) < nearest.at(cell_of(surface.point_mm[i])) + slack;
  }
  return seen;
}

std::vector<PrimitiveWorth> rank_primitives(const Surface& surface, const std::vector<RestingPosition>& resting,
                                            std::vector<Primitive>& primitives) {
  std::vector<int> owner(surface.point_mm.size());
  for (std::size_t i = 0; i < owner.size(); ++i) {
    owner[i] = primitive_of(primitives, surface.point_mm[i].cast<double>(), surface.normal[i].cast<double>());
  }
  std::vector<PrimitiveWorth> worth(primitives.size());
  for (const RestingPosition& position : resting) {
    const std::vector<bool> seen = seen_along(surface, position.down);
    std::vector<double> points(primitives.size(), 0.0);
    double all = 1.0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!seen[i]) continue;
      // A measurement counts by the pixels it fills.
      const double area = -surface.normal[i].cast<double>().dot(position.down);
      all += area;
      if (owner[i] >= 0) points[static_cast<std::size_t>(owner[i])] += area;
    }
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const double share = points[p] / all;
      worth[p].visible_share += position.likelihood * share;
      if (share >= (curved(primitives[p]) ? kCurvedEnough : kFaceEnough))
        worth[p].visible_enough += position.likelihood;
    }
  }
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    worth[p].alike =
        static_cast<int>(std::count_if(primitives.begin(), primitives.end(),
                                       [&](const Primitive& other) { return mistakable(primitives[p], other); })) -
        1;
    worth[p].freedoms = freedoms_left(primitives[p]);
    // Every freedom that is left multiplies the poses to try; what is alike does so once for all.
    worth[p].usefulness = (6 - worth[p].freedoms) * worth[p].visible_share / (1.0 + worth[p].alike);
  }
  std::vector<std::size_t> order(primitives.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return worth[a].usefulness > worth[b].usefulness; });
  std::vector<Primitive> ranked;
  std::vector<PrimitiveWorth> ranked_worth;
  for (const std::size_t p : order) {
    ranked.push_back(primitives[p]);
    ranked_worth.push_back(worth[p]);
  }
  primitives = std::move(ranked);
  return ranked_worth;
}

std::vector<RecognitionRoute> plan_routes(const PartTemplate& part, const std::vector<PrimitiveWorth>& worth,
                                          const SearchSteps& steps) {
  std::vector<RecognitionRoute> routes;
  const auto add = [&](bool of_curved) {
    for (std::size_t p = 0; p < part.primitives.size(); ++p) {
      if (curved(part.primitives[p]) != of_curved || worth[p].visible_enough < kNowAndThen) continue;
      routes.push_back(
          {static_cast<int>(p), std::min(1.0, worth[p].visible_enough), poses_of(part.primitives[p], part, steps)});
    }
  };
  add(true);
  routes.push_back(
      {-1, 1.0, static_cast<int>(kViews * std::ceil(2 * kPi / (steps.turn_rad > 0 ? steps.turn_rad : kTurn_rad)))});
  add(false);
  return routes;
}

}  // namespace beltpick::teach
