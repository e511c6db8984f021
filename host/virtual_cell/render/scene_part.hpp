// ScenePart: a part of the virtual cell: its surface, its mass, its symmetries and where a gripper may take it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/mesh.hpp"
#include "contract/part_template.hpp"

namespace beltpick::virtual_cell {

class BoardPrint;

// What a part's surface is made of; see surface.hpp.
enum class Finish : std::uint8_t {
  kSteel,      // rough cast steel with oil
  kMattWhite,  // sprayed white: targets of known shape
  kPrinted     // a white plate with a dark print
};

struct ScenePart {
  std::string name;
  Mesh mesh;                         // part frame, mm, closed, counter-clockwise from outside
  std::vector<Vec3f> corner_normal;  // three a face: smooth over rounded surfaces, split at creases
  Vec3 centre_of_mass_mm = Vec3::Zero();
  double volume_mm3 = 0.0;
  Mat3 inertia_mm5 = Mat3::Zero();                         // about the centre of mass, for density 1
  std::vector<Pose<frame::Part, frame::Part>> symmetries;  // non-trivial turns that map the part onto itself
  std::vector<Grasp> grasps;
  Finish finish = Finish::kSteel;
  std::shared_ptr<const BoardPrint> print;  // of a kPrinted part
};

// Works out mass properties and corner normals of a closed mesh. Errors: kMeshInvalid when it has no faces, encloses
// no volume or is of no size that a belt carries (5 mm to 2 m).
Result<ScenePart> make_part(std::string name, Mesh mesh);

// The built-in parts of builtin_part_names(). Errors: kUsage for another name.
Result<ScenePart> builtin_part(const std::string& name);
std::vector<std::string> builtin_part_names();

// The part as a mirror shows it (x -> -x), with its grasps; named `name`.
ScenePart mirrored(const ScenePart& part, std::string name);

// A built-in part by its name, or a mesh file (named after its stem) with `mm_per_unit`.
// Errors: as builtin_part, make_part and contract_io::read_mesh.
Result<ScenePart> load_part(const std::string& name_or_file, double mm_per_unit = 1.0);

// Writes `<folder>/<name>.stl` and, where the part has grasps, `<folder>/<name>.grasps.toml`. Errors: kFileNotWritten.
Result<void> write_part(const ScenePart& part, const std::filesystem::path& folder);

}  // namespace beltpick::virtual_cell
