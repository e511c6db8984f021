// Least squares of a model on its own inliers.
#pragma once

#include "primitives/model.hpp"

namespace beltpick::primitives {

// Gauss-Newton on the distances to the surface, `rounds` times over the inliers of the moment, with the inliers chosen
// and weighted (Tukey) at `widening` times the query's standard deviation: wider than 1 it also catches what a rough
// hypothesis misses. A known radius stays as it is. Returns false, and leaves the model, where the points do not
// determine it.
bool refine(const Cloud& cloud, const PrimitiveQuery& query, int rounds, double widening, Model& model);

}  // namespace beltpick::primitives
