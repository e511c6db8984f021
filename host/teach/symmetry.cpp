#include "teach/symmetry.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.hpp"
#include "teach/neighbours.hpp"

namespace beltpick::teach {

namespace {

using Turn = Pose<frame::Part, frame::Part>;

constexpr std::array kOrders{2, 3, 4, 5, 6, 8};
// Turns by these hold for all angles only if the surface is one of revolution: none is a simple fraction of a circle.
constexpr std::array kOddAngles_rad{0.31, 1.07, 1.93, 2.71};
// A turn leaves a surface unchanged if all but so little of it comes to lie on itself again within twice the tolerance,
// and within the tolerance all but what a mesh may be off at its edges.
constexpr double kMarkShare = 0.0005;
constexpr double kMeshedEdgesShare = 0.003;
// Where a mesh made of a volume bends, it cuts corners by some tenths of a millimetre, elsewhere on every edge. Less
// than this many tolerances, only there, is nothing that a measurement tells.
constexpr float kCreaseTolerances = 2.5F;
constexpr float kCreaseCosine = 0.87F;        // neighbours that look farther apart (30 degrees) are at a crease
constexpr float kFacingCosine = 0.7F;         // what looks the same way, ..
constexpr float kCreaseFacingCosine = 0.45F;  // .. where a cut corner looks half to either side
constexpr double kNearShare = 0.05;
constexpr std::size_t kQuickSample = 600;
constexpr std::size_t kMaxElements = 59;

Turn turn_about(const Vec3& centre, const Vec3& axis, double angle_rad) {
  Turn turn;
  turn.rotation = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
  turn.translation_mm = centre - turn.rotation * centre;
  return turn;
}

// Measures how much of a surface a turn moves off itself.
class TurnTest {
 public:
  TurnTest(const Surface& surface, double tolerance_mm)
      : surface_(surface),
        index_(surface.point_mm),
        tolerance_mm_(static_cast<float>(tolerance_mm)),
        at_crease_(surface.point_mm.size()) {
    for (std::size_t i = 0; i < at_crease_.size(); ++i) at_crease_[i] = bends_at(i);
  }

  // Share of the surface that does not come to lie on it again, within so many tolerances; from every point or a quick
  // sample.
  [[nodiscard]] double differing_share(const Turn& turn, bool quick, float tolerances = 1.0F) const {
    const std::size_t count = surface_.point_mm.size();
    const std::size_t step = quick ? std::max<std::size_t>(1, count / kQuickSample) : 1;
    const float within_mm = tolerances * tolerance_mm_;
    std::size_t tried = 0;
    std::size_t off = 0;
    for (std::size_t i = 0; i < count; i += step, ++tried) {
      if (moved_off(i, turn, within_mm)) ++off;
    }
    return static_cast<double>(off) / static_cast<double>(tried);
  }

  // Whether point `i` does not come to lie on the surface again.
  [[nodiscard]] bool moved_off(std::size_t i, const Turn& turn, float within_mm) const {
    const Vec3f point = (turn * Vec3(surface_.point_mm[i].cast<double>())).cast<float>();
    const Vec3f normal = (turn.rotation * surface_.normal[i].cast<double>()).cast<float>();
    return !on_surface(point, normal, at_crease_[i], within_mm);
  }

  // The turn, shifted so that the turned surface lies on the surface best: a mark on one side of a part draws the
  // centroid away from the axis. Point to plane, translation only.
  [[nodiscard]] Turn settled(Turn turn) const {
    const std::size_t step = std::max<std::size_t>(1, surface_.point_mm.size() / kQuickSample);
    for (const float reach_mm : {4.0F, 2.0F, 1.0F}) {
      Mat3 normal_matrix = 1e-6 * Mat3::Identity();
      Vec3 right_side = Vec3::Zero();
      for (std::size_t i = 0; i < surface_.point_mm.size(); i += step) {
        const Vec3f point = (turn * Vec3(surface_.point_mm[i].cast<double>())).cast<float>();
        std::array<Neighbour, 1> near;
        index_.nearest(point, near);
        const Vec3f& normal = surface_.normal[near[0].index];
        const float distance = normal.dot(surface_.point_mm[near[0].index] - point);
        const bool alike = (turn.rotation * surface_.normal[i].cast<double>()).dot(normal.cast<double>()) > 0.7;
        if (!alike || std::abs(distance) > reach_mm) continue;
        const Vec3 n = normal.cast<double>();
        normal_matrix += n * n.transpose();
        right_side += static_cast<double>(distance) * n;
      }
      turn.translation_mm += normal_matrix.ldlt().solve(right_side);
    }
    return turn;
  }

  [[nodiscard]] bool unchanged(const Turn& turn) const {
    return differing_share(turn, true) < 0.01 && differing_share(turn, false) <= kMeshedEdgesShare &&
           differing_share(turn, false, 2.0F) <= kMarkShare;
  }

 private:
  // On the tangent plane of a neighbour that looks the same way: at an edge the nearest point may be on the other face.
  [[nodiscard]] bool on_surface(const Vec3f& point, const Vec3f& normal, bool at_crease, float within_mm) const {
    std::array<Neighbour, 8> near;
    index_.nearest(point, near);
    const auto reach = static_cast<float>(2.5 * surface_.spacing_mm);
    const float facing = at_crease ? kCreaseFacingCosine : kFacingCosine;
    if (at_crease) within_mm = std::max(within_mm, kCreaseTolerances * tolerance_mm_);
    return std::any_of(near.begin(), near.end(), [&](const Neighbour& n) {
      const Vec3f& n_normal = surface_.normal[n.index];
      return n.squared_mm2 < reach * reach && n_normal.dot(normal) > facing &&
             std::abs(n_normal.dot(point - surface_.point_mm[n.index])) < within_mm;
    });
  }

  [[nodiscard]] bool bends_at(std::size_t i) const {
    std::array<Neighbour, 8> near;
    index_.nearest(surface_.point_mm[i], near);
    return std::any_of(near.begin(), near.end(), [&](const Neighbour& n) {
      return surface_.normal[n.index].dot(surface_.normal[i]) < kCreaseCosine;
    });
  }

  const Surface& surface_;
  NeighbourIndex index_;
  float tolerance_mm_;
  std::vector<bool> at_crease_;  // of each point
};

Vec3 centroid_of(const Surface& surface) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3f& point : surface.point_mm) sum += point.cast<double>();
  return sum / static_cast<double>(surface.point_mm.size());
}

void add_axis(std::vector<Vec3>& axes, const Vec3& direction) {
  if (direction.norm() < 1e-6) return;
  const Vec3 unit = direction.normalized();
  const bool known = std::any_of(axes.begin(), axes.end(),
                                 [&](const Vec3& a) { return std::abs(a.dot(unit)) > std::cos(rad_from_deg(0.2)); });
  if (!known) axes.push_back(unit);
}

// The directions of the primitives come first: they are more exact than principal axes, whose ends may coincide.
std::vector<Vec3> candidate_axes(const Surface& surface, const Vec3& centroid,
                                 const std::vector<Primitive>& primitives) {
  std::vector<Vec3> axes;
  for (const Primitive& primitive : primitives) {
    if (primitive.kind != PrimitiveKind::kSphere) add_axis(axes, primitive.direction);
  }
  const std::size_t of_primitives = axes.size();
  for (std::size_t i = 0; i < of_primitives; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      add_axis(axes, axes[i].cross(axes[j]));
      add_axis(axes, axes[i] + axes[j]);
      add_axis(axes, axes[i] - axes[j]);
    }
  }
  Mat3 spread = Mat3::Zero();
  for (const Vec3f& point : surface.point_mm) {
    const Vec3 arm = point.cast<double>() - centroid;
    spread += arm * arm.transpose();
  }
  const Mat3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors();
  for (int k = 0; k < 3; ++k) add_axis(axes, principal.col(k));
  return axes;
}

bool same_turn(const Turn& a, const Turn& b) {
  return rotation_between_rad(a.rotation, b.rotation) < rad_from_deg(1.5);
}

void add_turn(std::vector<Turn>& turns, const Turn& turn) {
  if (same_turn(turn, Turn{})) return;
  const bool known = std::any_of(turns.begin(), turns.end(), [&](const Turn& t) { return same_turn(t, turn); });
  if (!known) turns.push_back(turn);
}

// Products of symmetries are symmetries.
void close_group(std::vector<Turn>& turns) {
  for (std::size_t i = 0; i < turns.size() && turns.size() < kMaxElements; ++i) {
    for (std::size_t j = 0; j < turns.size() && turns.size() < kMaxElements; ++j) add_turn(turns, turns[i] * turns[j]);
  }
}

// Schoenflies' name of the group: Cn about one axis, Dn with flips across it, T, O or I.
std::string group_name(const std::vector<Turn>& turns) {
  if (turns.empty()) return "none";
  const std::size_t order = turns.size() + 1;
  std::size_t best = 0;
  for (const Turn& turn : turns) {
    const Vec3 axis = Eigen::AngleAxisd(turn.rotation).axis();
    const auto about = std::count_if(turns.begin(), turns.end(), [&](const Turn& t) {
      return std::abs(Eigen::AngleAxisd(t.rotation).axis().dot(axis)) > std::cos(rad_from_deg(1.5));
    });
    best = std::max(best, static_cast<std::size_t>(about) + 1);
  }
  if (best == order) return "C" + std::to_string(order);
  if (2 * best == order) return "D" + std::to_string(best);
  return order == 12 ? "T" : order == 24 ? "O" : "I";
}

bool is_revolution(const TurnTest& test, const Vec3& centroid, const Vec3& axis) {
  return std::all_of(kOddAngles_rad.begin(), kOddAngles_rad.end(),
                     [&](double angle) { return test.unchanged(turn_about(centroid, axis, angle)); });
}

void note_near_turn(SymmetryReport& report, const TurnTest& test, const Turn& turn) {
  const Turn settled = test.settled(turn);
  if (test.differing_share(settled, true) > kNearShare) return;
  const double share = test.differing_share(settled, false);
  if (share > kNearShare || (report.nearest_turn && report.nearest_turn->differing_share <= share)) return;
  const Eigen::AngleAxisd angle_axis(turn.rotation);
  report.nearest_turn = {share, angle_axis.angle(), angle_axis.axis(), settled};
}

}  // namespace

std::vector<bool> moved_off(const Surface& surface, const Turn& turn, double tolerance_mm) {
  const TurnTest test(surface, tolerance_mm);
  std::vector<bool> off(surface.point_mm.size());
  for (std::size_t i = 0; i < off.size(); ++i) off[i] = test.moved_off(i, turn, static_cast<float>(tolerance_mm));
  return off;
}

SymmetryReport find_symmetry(const Surface& surface, const std::vector<Primitive>& primitives, double tolerance_mm) {
  SymmetryReport report;
  const TurnTest test(surface, tolerance_mm);
  const Vec3 centroid = centroid_of(surface);
  Symmetry& symmetry = report.symmetry;
  symmetry.axis_point_mm = centroid;
  std::vector<Vec3> revolution_axes;
  for (const Vec3& axis : candidate_axes(surface, centroid, primitives)) {
    if (is_revolution(test, centroid, axis)) revolution_axes.push_back(axis);
    for (const int order : kOrders) {
      const double angle_rad = 2 * kPi / order;
      const Turn turn = turn_about(centroid, axis, angle_rad);
      if (test.unchanged(turn)) {
        add_turn(symmetry.elements, turn);
      } else {
        note_near_turn(report, test, turn);
      }
    }
  }
  if (revolution_axes.empty()) {
    close_group(symmetry.elements);
    symmetry.name = group_name(symmetry.elements);
    return report;
  }
  symmetry.revolution = true;
  symmetry.axis_direction = revolution_axes.front();
  symmetry.name = revolution_axes.size() > 1 ? "sphere" : "revolution";
  // Beside the revolution only the flip is a symmetry of its own.
  symmetry.elements.clear();
  const Turn flip = turn_about(centroid, symmetry.axis_direction.unitOrthogonal(), kPi);
  if (test.unchanged(flip)) symmetry.elements.push_back(flip);
  report.nearest_turn.reset();
  if (symmetry.elements.empty()) note_near_turn(report, test, flip);
  return report;
}

}  // namespace beltpick::teach
