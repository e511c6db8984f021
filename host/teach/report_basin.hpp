// The parts of the teaching report that come from the rehearsal: accuracy by freedom, and ICP's basin.
#pragma once

#include <string>

#include "teach/rehearsal.hpp"

namespace beltpick::teach {

// What the poses found were off by, a row a freedom. HTML.
std::string accuracy_table(const Rehearsal& rehearsal);

// The share of starts that came home over how far off they were, a line a freedom, and the steps chosen. HTML.
std::string basin_pictures(const Rehearsal& rehearsal);

}  // namespace beltpick::teach
