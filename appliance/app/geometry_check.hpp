// Whether a calibration and a cell can be those of a belt cell at all: a file in metres, of another rig or by a broken
// fit is refused before it measures anything.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/calibration.hpp"

namespace beltpick::app {

// `source` stands in messages. Error: kValueOutOfRange. What is odd but may be so is added to `warnings`.
Result<void> check_plausible(const Calibration& calibration, const std::string& source);
Result<void> check_plausible(const Cell& cell, const std::string& source, std::vector<std::string>& warnings);

}  // namespace beltpick::app
