// A calibration's outcome for machines.
#pragma once

#include <string>

#include "calibrate/outcome.hpp"

namespace beltpick::calibrate {

// The text of report.json: all of `outcome` but the geometry itself, which stands in calibration.json.
std::string outcome_json(const Outcome& outcome);

// The text of calibration.json's member "quality": the figures by which to trust it, and the verdict.
std::string quality_json(const Outcome& outcome);

}  // namespace beltpick::calibrate
