// PartModel: a template as the pose stages use it: fixed size, its closest-point index built, nothing to allocate.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/closest_point_grid.hpp"
#include "base/closest_point_tree.hpp"
#include "base/point_block.hpp"
#include "base/pose.hpp"
#include "base/stages.hpp"
#include "contract/gripper.hpp"
#include "contract/requirements.hpp"

namespace beltpick {

// The part as it is seen from one direction.
struct PartView {
  Vec3f direction = -Vec3f::UnitZ();  // of the line of sight, part frame, away from the camera
  Vec3f centroid_mm = Vec3f::Zero();  // of the surface seen, part frame
  float seen_area = 0.0F;             // across the line of sight, mm^2
};

// A grasp without its name.
struct GraspPose {
  Pose<frame::Part, frame::Gripper> T_part_gripper;
  double opening_mm = 0.0;
  bool clear_of_part = true;  // the open jaws do not meet the part itself
};

// Points all over the part's surface, as they are drawn.
struct SurfaceBlocks {
  std::span<const PointBlock> blocks;  // all full but the last
  std::size_t count = 0;               // of points
  float spacing_mm = 1.0F;
  float stands_for = 1.0F;  // points of the template, each of these
};

struct PartModel {
  static constexpr int kMaxPrimitives = 16;
  static constexpr int kMaxSymmetries = 128;
  static constexpr int kMaxGrasps = 32;
  static constexpr int kViews = 162;  // a twice divided icosahedron: 15 to 18 degrees from view to view

  std::span<const OrientedPoint> surface;  // part frame, outward normals
  SurfaceBlocks fine;                      // the same, in order
  SurfaceBlocks coarse;                    // about a quarter of them, evenly spread
  std::span<const PointBlock> scattered;   // some of them, spread at random over the surface; all full
  float spacing_mm = 1.0F;
  Vec3 centre_mm = Vec3::Zero();  // of the bounding box
  Vec3 box_min_mm = Vec3::Zero();
  Vec3 box_max_mm = Vec3::Zero();
  double diagonal_mm = 1.0;  // of the bounding box

  ClosestPointGrid grid;
  const ClosestPointTree* tree = nullptr;  // asked instead of the grid where set

  std::array<PartView, kViews> views{};
  std::array<Primitive, kMaxPrimitives> primitives{};
  int primitive_count = 0;
  // Which of them are looked for in an object, in this order: those that a camera over the belt sees now and then. All
  // of them where the template does not tell.
  std::array<std::uint8_t, kMaxPrimitives> routes{};
  int route_count = 0;
  // From pose to pose of a search. Shifts over a face, which ICP and outline settle, may be coarser than along an axis.
  double turn_step_rad = 0.0;
  double shift_step_mm = 0.0;
  double face_step_mm = 0.0;

  // The turns that leave the surface unchanged: see Symmetry in part_template.hpp. The identity is not among them.
  std::array<Pose<frame::Part, frame::Part>, kMaxSymmetries> symmetries{};
  int symmetry_count = 0;
  bool revolution = false;
  bool sphere = false;  // any turn about axis_point_mm
  Vec3 axis_point_mm = Vec3::Zero();
  Vec3 axis_direction = Vec3::UnitZ();

  std::array<GraspPose, kMaxGrasps> grasps{};
  int grasp_count = 0;
  GripperShape gripper;  // that picks it

  Requirements required;  // of a pose of it

  // The surface point nearest to a place in the part frame.
  [[nodiscard]] const OrientedPoint& nearest(const Vec3f& at_part_mm) const {
    return surface[tree == nullptr ? grid.nearest(at_part_mm) : tree->nearest(at_part_mm)];
  }
  // At least so far is a place in the part frame from the surface: it lies so far outside the part's box.
  [[nodiscard]] float outside_box_mm(const Vec3f& at_part_mm) const {
    const Vec3f low = box_min_mm.cast<float>() - at_part_mm;
    const Vec3f high = at_part_mm - box_max_mm.cast<float>();
    return low.cwiseMax(high).maxCoeff();
  }
  [[nodiscard]] bool symmetric() const { return revolution || sphere || symmetry_count > 0; }
  [[nodiscard]] std::span<const Primitive> taught() const {
    return {primitives.data(), static_cast<std::size_t>(primitive_count)};
  }
  [[nodiscard]] std::span<const std::uint8_t> looked_for() const {
    return {routes.data(), static_cast<std::size_t>(route_count)};
  }
};

}  // namespace beltpick
