// The report of a calibration: verdict in words, pictures of what was covered and what was left over, figures; and the
// same for machines.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "calibrate/outcome.hpp"

namespace beltpick::calibrate {

// Writes index.html, which carries its pictures, and report.json into `folder`, which is made. Error: kFileNotWritten.
Result<void> write_report(const std::filesystem::path& folder, const Outcome& outcome);

}  // namespace beltpick::calibrate
