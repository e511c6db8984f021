// What the part can be recognised by: how much of each primitive a camera over the belt sees, how many others look like
// it, which freedoms it leaves; and the routes a search takes from there.
#pragma once

#include <vector>

#include "contract/part_template.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

struct PrimitiveWorth {
  double visible_share = 0.0;   // of what is seen of the part, over its resting positions
  double visible_enough = 0.0;  // likelihood that so much of it is seen as a search asks for
  int alike = 0;                // other primitives that it may be mistaken for
  int freedoms = 0;             // that it leaves
  double usefulness = 0.0;      // what ranks it
};

// Which surface points a camera sees along `direction` (part frame, unit), the part's own surface hiding what is
// behind.
std::vector<bool> seen_along(const Surface& surface, const Vec3& direction);

// Sorts the primitives, most useful first, and tells the worth of each.
std::vector<PrimitiveWorth> rank_primitives(const Surface& surface, const std::vector<RestingPosition>& resting,
                                            std::vector<Primitive>& primitives);

// One from every primitive that is seen now and then, in the order in which the appliance tries them, and one that
// needs none. `steps` of 0: the appliance's own.
std::vector<RecognitionRoute> plan_routes(const PartTemplate& part, const std::vector<PrimitiveWorth>& worth,
                                          const SearchSteps& steps);

}  // namespace beltpick::teach
