// Whether what a template tells can be a part: sizes, directions, turns. Internal to contract_io.
#pragma once

#include <string>

#include "base/result.hpp"
#include "contract/part_template.hpp"

namespace beltpick::contract_io {

// Bounding box, spacing, points within the box, unit normals, primitives, symmetry and grasps, all finite and of a size
// that a belt can carry. `source` stands in messages. Error: kValueOutOfRange.
Result<void> judge_template(const PartTemplate& part, const std::string& source);

}  // namespace beltpick::contract_io
