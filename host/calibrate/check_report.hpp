// A field check of a calibration in words, figures and pictures: where on the plate it is off, and which way.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "calibrate/plate_check.hpp"

namespace beltpick::calibrate {

struct CheckedFiles {
  std::string capture, calibration;
};

// Writes index.html, which carries its pictures, into `folder`, which is made. `square_mm` of the plate's board.
// Errors: kDiskFull, kFileNotWritten.
Result<void> write_check_report(const std::filesystem::path& folder, const CheckedFiles& files, const PlateCheck& check,
                                double square_mm);

}  // namespace beltpick::calibrate
