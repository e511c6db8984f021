// Gathers the outcome of a calibration from its solution: figures only, no judgement.
#pragma once

#include <optional>
#include <vector>

#include "calibrate/bundle.hpp"
#include "calibrate/held_out.hpp"
#include "calibrate/outcome.hpp"

namespace beltpick::calibrate {

// All but left_out, grade and verdict.
Outcome gather(const Observations& seen, const Selection& use, const BundleResult& solution,
               const std::vector<std::optional<MeasuredPlate>>& held_out);

// Writes the reasons of outcome.left_out to the poses and corners they are of.
void name_left_out(Outcome& outcome);

}  // namespace beltpick::calibrate
