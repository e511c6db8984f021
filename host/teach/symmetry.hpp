// The turns that leave a part's surface unchanged.
#pragma once

#include <optional>
#include <vector>

#include "contract/part_template.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

struct SymmetryReport {
  Symmetry symmetry;
  // The turn that changes least among those that do change the surface: the share of the surface by which it can be
  // told, and its angle. Empty where no turn comes near. A small share means that poses may be hard to tell apart.
  struct NearTurn {
    double differing_share = 0.0;
    double angle_rad = 0.0;
    Vec3 axis_direction = Vec3::UnitZ();
    Pose<frame::Part, frame::Part> turn;
  };
  std::optional<NearTurn> nearest_turn;
};

// Which points come to lie off the surface when it is turned so: where a pose and its turned twin can be told apart.
std::vector<bool> moved_off(const Surface& surface, const Pose<frame::Part, frame::Part>& turn, double tolerance_mm);

// Tries turns of order 2, 3, 4, 5, 6 and 8 and any turn about axes through the surface's centroid: the principal axes
// and those of `primitives`, and what lies between them. A turn counts when all but 0.05 % of the surface comes to lie
// on the surface again, within `tolerance_mm`.
SymmetryReport find_symmetry(const Surface& surface, const std::vector<Primitive>& primitives, double tolerance_mm);

}  // namespace beltpick::teach
