#include "virtual_cell/world/gripper_path.hpp"

#include <array>
#include <cmath>

namespace beltpick::virtual_cell {
namespace {

using Triangle = std::array<Vec3, 3>;  // about the box's centre

bool separates(const Vec3& axis, const Triangle& triangle, const Vec3& half) {
  const double a = axis.dot(triangle[0]);
  const double b = axis.dot(triangle[1]);
  const double c = axis.dot(triangle[2]);
  const double reach = half.dot(axis.cwiseAbs());
  return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
}

bool triangle_meets_box(const Triangle& triangle, const Vec3& half) {
  for (int i = 0; i < 3; ++i) {
    if (separates(Vec3::Unit(i), triangle, half)) return false;
  }
  const std::array<Vec3, 3> edges{triangle[1] - triangle[0], triangle[2] - triangle[1], triangle[0] - triangle[2]};
  if (separates(edges[0].cross(edges[1]), triangle, half)) return false;
  for (const Vec3& edge : edges) {
    for (int i = 0; i < 3; ++i) {
      if (separates(Vec3::Unit(i).cross(edge), triangle, half)) return false;
    }
  }
  return true;
}

}  // namespace

JawSweep jaw_sweep(const GripperShape& shape, double opening_mm, int side) {
  const double inner = opening_mm / 2.0;
  const double outer = inner + shape.jaw_thickness_mm;
  const double x_min = side > 0 ? inner : -outer;
  return {Vec3(x_min, -shape.jaw_width_mm / 2.0, shape.tip_mm - shape.reach_mm),
          Vec3(x_min + shape.jaw_thickness_mm, shape.jaw_width_mm / 2.0, shape.tip_mm)};
}

bool sweep_meets_mesh(const JawSweep& sweep, const Mesh& mesh,
                      const Pose<frame::Gripper, frame::Part>& T_gripper_part) {
  const Vec3 half = sweep.sizes() / 2.0;
  const Vec3 centre = sweep.center();
  for (const auto& face : mesh.face) {
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = T_gripper_part * mesh.vertex_mm[face[k]].cast<double>() - centre;
    }
    if (triangle_meets_box(triangle, half)) return true;
  }
  return false;
}

bool sweep_meets_belt(const JawSweep& sweep, const Pose<frame::Belt, frame::Gripper>& T_belt_gripper) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 point = sweep.corner(static_cast<JawSweep::CornerType>(corner));
    if ((T_belt_gripper * point).z() < 0.0) return true;
  }
  return false;
}

}  // namespace beltpick::virtual_cell
