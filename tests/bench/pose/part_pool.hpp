// PartPool: everything that may lie on the bench's belt: part families, their mirror twins, foreign things; and the
// templates that `beltpick teach` made of the first two.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "contract/part_template.hpp"
#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::bench {

struct PartPool {
  std::vector<virtual_cell::ScenePart> parts;  // families first, then twins, then foreign things
  std::vector<int> families;                   // indices into parts
  std::vector<int> twin_of;                    // of each part the index of its mirror image, -1 without one
  std::vector<int> foreign;
  std::vector<PartTemplate> templates;  // of families and twins, by their index in parts
};

// Templates are read from `folder` where it has them, else taught into it.
PartPool make_part_pool(const std::vector<std::string>& families, const std::filesystem::path& folder);

}  // namespace beltpick::bench
