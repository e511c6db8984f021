// explain.json: the numbers of the explanation, for machines.
#pragma once

#include <string>
#include <vector>

#include "explain/chapter.hpp"
#include "explain/explain.hpp"

namespace beltpick::explain {

// `parts` and `withheld` as result.json counts them, with what search, alignment and verification measured; `segments`
// with every route tried: primitives, the Q maps with all their cells, hypotheses aligned, poses judged, rivals.
std::string explanation_json(const Explained& explained, const std::vector<Chapter>& chapters);

}  // namespace beltpick::explain
