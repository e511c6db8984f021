#include "teach/default_grasps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.hpp"
#include "contract_io/grasps_io.hpp"

namespace beltpick::teach {

namespace {

constexpr double kJawHalfWidth_mm = 8.0;  // what is gripped between the jaws, across closing and approach
constexpr double kClearance_mm = 4.0;     // on either side, on the way in
constexpr double kFingerDepth_mm = 12.0;  // how far the tips reach below the first contact
constexpr std::size_t kMaxGrasps = 24;

struct Reach {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool empty() const { return low > high; }
};

// A grasp near `centre`: the tips reach kFingerDepth_mm past the first surface met on the way in, or to its middle.
void add_grasp(const Surface& surface, const Vec3& centre, const Vec3& approach, const Vec3& closing, const char* name,
               std::vector<Grasp>& grasps) {
  const Vec3 across = approach.cross(closing);
  Reach along;
  for (const Vec3f& p : surface.point_mm) {
    const Vec3 arm = p.cast<double>() - centre;
    if (std::abs(arm.dot(across)) < kJawHalfWidth_mm && std::abs(arm.dot(closing)) < kJawHalfWidth_mm)
      along.add(arm.dot(approach));
  }
  if (along.empty()) return;
  const double depth_mm = std::min(along.low + kFingerDepth_mm, 0.5 * (along.low + along.high));
  Reach between;
  for (const Vec3f& p : surface.point_mm) {
    const Vec3 arm = p.cast<double>() - centre;
    if (std::abs(arm.dot(across)) < kJawHalfWidth_mm && arm.dot(approach) < depth_mm) between.add(arm.dot(closing));
  }
  if (between.empty()) return;
  const Vec3 position_mm = centre + depth_mm * approach + 0.5 * (between.low + between.high) * closing;
  grasps.push_back({name, contract_io::gripper_pose(position_mm, approach, closing),
                    between.high - between.low + 2 * kClearance_mm});
}

}  // namespace

std::vector<Grasp> default_grasps(const Surface& surface, const std::vector<Primitive>& primitives,
                                  double opening_max_mm) {
  std::vector<Grasp> grasps;
  Vec3 centroid = Vec3::Zero();
  for (const Vec3f& p : surface.point_mm) centroid += p.cast<double>() / static_cast<double>(surface.point_mm.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      for (int turn = 1; turn < 3; ++turn) {
        add_grasp(surface, centroid, sign * Vec3::Unit(axis), Vec3::Unit((axis + turn) % 3), "middle", grasps);
      }
    }
  }
  for (const Primitive& boss : primitives) {
    if (boss.kind != PrimitiveKind::kCylinder || boss.concave) continue;
    const Vec3 side = boss.direction.unitOrthogonal();
    for (int k = 0; k < 8; ++k) {
      const Vec3 approach = Eigen::AngleAxisd(k * kPi / 4, boss.direction) * side;
      add_grasp(surface, boss.point_mm, approach, boss.direction.cross(approach), "boss", grasps);
    }
  }
  std::erase_if(grasps, [&](const Grasp& grasp) { return grasp.opening_mm > opening_max_mm; });
  std::stable_sort(grasps.begin(), grasps.end(),
                   [](const Grasp& a, const Grasp& b) { return a.opening_mm < b.opening_mm; });
  if (grasps.size() > kMaxGrasps) grasps.resize(kMaxGrasps);
  return grasps;
}

}  // namespace beltpick::teach
