// The search that needs no primitive: the part as seen from every side, its seen centre laid on the object's.
#pragma once

#include <array>

#include "contract/part_model.hpp"
#include "search/from_primitive.hpp"

namespace beltpick::search {

// Unit vectors spread evenly over the sphere: the corners of an icosahedron whose faces were divided twice.
const std::array<Vec3, PartModel::kViews>& view_directions();

// Fills model.views from model.surface: what is seen from each direction, and where its centre lies. For loading.
void compute_views(PartModel& model);

// Tries every view x 24 turns about the line of sight. Returns how many were tried.
int search_views(const SearchInput& input, HypothesisPool& pool);

}  // namespace beltpick::search
