// Candidate primitives from the least number of points drawn at random.
#pragma once

#include <optional>

#include "primitives/model.hpp"

namespace beltpick::primitives {

// Points that one hypothesis is made from: decides how many must be drawn to be confident.
int sample_size(const PrimitiveQuery& query);

// Draws a sample and makes the model through it; nothing where the sample is degenerate or breaks the query's bounds.
std::optional<Model> draw_hypothesis(const Cloud& cloud, const PrimitiveQuery& query, Random& random);

}  // namespace beltpick::primitives
