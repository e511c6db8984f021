// A capture of the calibration plate: its corners as camera and projector see them.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "calibrate/observations.hpp"
#include "contract/capture.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::cli {

struct PlateCapture {
  calibrate::ObservedPose pose;
  int camera_width = 0, camera_height = 0;
  ProjectorGrid projector;
};

// Decodes the capture and finds `board` in it. Errors: as MeasuredCapture::make; kSequenceUndecodable where one axis of
// the projector is not coded; kNothingFound where the plate is not found. The message names the capture.
Result<PlateCapture> read_plate(const std::filesystem::path& path, const calibrate::Board& board,
                                contract_io::Warnings& warnings, bool quiet);

}  // namespace beltpick::cli
