// A Q map as coloured pictures with axes: the paper's figure 7, seen from above.
#pragma once

#include <optional>
#include <vector>

#include "explain/q_map.hpp"
#include "html/page.hpp"

namespace beltpick::explain {

// A figure a panel, all on one scale of colours; a ring marks the least Q.
std::vector<html::Figure> q_map_figures(const QMap& map);

}  // namespace beltpick::explain
