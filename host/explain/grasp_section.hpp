// The grasps of a located part on the page: which can be reached, and what keeps the others from it.
#pragma once

#include <string>

#include "explain/explain.hpp"

namespace beltpick::explain {

// `part_index`: into the located parts.
std::string grasp_section(int part_index, const Explained& explained);

}  // namespace beltpick::explain
