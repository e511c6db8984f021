// In which order located parts are offered: top-most, clear of neighbours, best verified.
#pragma once

#include <cstddef>
#include <span>

#include "contract/locate_result.hpp"

namespace beltpick::pipeline {

// Writes the indices of `parts` in pick order to `order`, which has their number. First those that can be gripped. Of
// these whatever lies in the top layer (within 10 mm of the highest that is left) comes next: there first what nothing
// hides, then what touches nothing, then the better verified one.
void order_picks(std::span<const LocatedPart> parts, std::span<std::size_t> order);

}  // namespace beltpick::pipeline
