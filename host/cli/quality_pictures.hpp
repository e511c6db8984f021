// `beltpick decode --quality`: pictures and counts that say of each pixel how well it is measured, or why it is not.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "measured_capture.hpp"

namespace beltpick::cli {

// Writes into `folder`, which is made:
//   states.png      every pixel in the colour of its state, valid ones shaded by the texture
//   modulation.png  amplitude of the fringe, 8 bit, brightest 99th percentile at 255
//   sigma_px.png    predicted standard deviation of the code, and with a calibration sigma_mm.png of the point
//   order.png       every fringe (or Gray cell) in a colour of its own
//   legend.txt      what the colours mean
//   quality.json    counts by state, and the scales of the pictures
// Error: kFileNotWritten.
Result<void> write_quality(const std::filesystem::path& folder, const MeasuredCapture& measured);

}  // namespace beltpick::cli
