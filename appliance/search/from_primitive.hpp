// Exhaustive search over the freedoms that a matched primitive leaves (the paper's section 3.3).
#pragma once

#include "base/stages.hpp"
#include "contract/part_model.hpp"
#include "search/hypothesis_pool.hpp"
#include "search/trials.hpp"

namespace beltpick::search {

// Assumes that `found` (camera frame) is the part's `taught` primitive (part frame) and tries what is then still free:
//   cylinder: flip x turns about the axis x shifts along it that keep the two lengths overlapping
//   plane:    turns about the normal x shifts in the plane around where the two centres meet
//   sphere:   all rotations about the centre
// by the model's steps. Better hypotheses go to the pool. Returns how many were tried; 0 where the kinds, radii or
// sides do not match.
int search_from_primitive(const SearchInput& input, const Primitive& taught, const Primitive& found,
                          HypothesisPool& pool);

// Of a full turn by the model's step.
int turn_count(const PartModel& model);

// Whether `found` may be `taught`: the same kind and side, the radius within its tolerance.
bool may_match(const Primitive& taught, const Primitive& found);

// A rotation that takes the unit vector `from` to the unit vector `to`, and `turn_rad` about `to` after that.
Mat3 rotation_onto(const Vec3& from, const Vec3& to, double turn_rad);

}  // namespace beltpick::search
