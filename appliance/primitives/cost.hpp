// The MSAC cost, the paper's equations (4) and (5).
#pragma once

#include "primitives/model.hpp"

namespace beltpick::primitives {

// d = sum of rho(e_i^2), rho(e^2) = e^2 below T and T above; a point whose normal disagrees counts T too. Gives up,
// with what it has summed by then, once the sum exceeds `limit_mm2`: the hypothesis has lost already.
double cost_mm2(const Cloud& cloud, const Model& model, const PrimitiveQuery& query, double limit_mm2);

}  // namespace beltpick::primitives
