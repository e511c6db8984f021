// A comparison of two calibrations in words, figures and maps.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "calibrate/compare.hpp"

namespace beltpick::calibrate {

struct ParameterPair {
  std::string name;  // with its unit
  double old_value = 0.0;
  double new_value = 0.0;
};

// The parameters of both lenses, the baseline and the angle between the lenses' axes, side by side.
std::vector<ParameterPair> parameters_of(const Calibration& old_calibration, const Calibration& new_calibration);

// The best motion's angle, and how far it moves the middle of the belt.
double motion_deg(const Comparison& comparison);
double motion_mm(const Comparison& comparison);

// One or two sentences.
std::string verdict(const Comparison& comparison);

struct ComparedFiles {
  std::string old_name, new_name;
};

// Writes index.html into `folder`, which is made. Errors: kFileNotWritten.
Result<void> write_compare_report(const std::filesystem::path& folder, const ComparedFiles& files,
                                  const Comparison& comparison, const std::vector<ParameterPair>& parameters);

}  // namespace beltpick::calibrate
