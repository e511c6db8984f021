// Whether two located parts touch, where the camera sees it and where it does not.
#pragma once

#include "contract/part_model.hpp"
#include "result/rivalry.hpp"

namespace beltpick::result {

// True where the two surfaces come nearer than `reach_mm` anywhere. A part that leans on another rests on a few points
// which it mostly hides itself: the models tell, the range image cannot. The same for (a, b) and (b, a).
bool in_contact(const Rival& a, const Rival& b, double reach_mm);

}  // namespace beltpick::result
