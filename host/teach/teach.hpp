// From a mesh or a scan to a part template, with no parameter that a user must know.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/mesh.hpp"
#include "contract/part_template.hpp"
#include "teach/recognition.hpp"
#include "teach/surface.hpp"
#include "teach/symmetry.hpp"

namespace beltpick::teach {

struct TeachOptions {
  std::size_t points = 36600;     // of the template, as the paper's
  double opening_max_mm = 110.0;  // of default grasps
  double mm_per_unit = 1.0;       // that the mesh was read with: for advice on units
  std::uint64_t seed = 1;
};

struct Taught {
  PartTemplate part;
  Surface surface;
  MeshRepair repair;
  std::vector<PrimitiveWorth> worth;  // of each of part.primitives
  Vec3 centre_of_gravity_mm = Vec3::Zero();
  std::optional<SymmetryReport::NearTurn> nearest_turn;
  double symmetry_tolerance_mm = 0.0;  // within which a turned surface counts as the same
  std::vector<std::string> warnings;   // one line each: what, and what to do
};

// `mesh` in mm, part frame = the file's own coordinates. Grasps may be empty: then default ones are made. Errors:
// kMeshInvalid where the mesh has no area or a size that cannot be; kValueOutOfRange.
Result<Taught> teach(Mesh mesh, std::vector<Grasp> grasps, const TeachOptions& options);

// The planes, cylinders and spheres of a surface, largest first as they are found.
std::vector<Primitive> find_primitives(const Surface& surface, std::uint64_t seed);

}  // namespace beltpick::teach
