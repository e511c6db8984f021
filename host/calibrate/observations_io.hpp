// calibration.observations.json: the corners that a calibration was made of, so that it can be repeated without its
// captures.
//
//   {"format": "beltpick-calibration-observations", "version": 1,
//    "board": {"columns", "rows", "square_mm", for ChArUco also "marker_mm", "dictionary"},
//    "camera": {"width", "height"}, "projector": {"width", "height", "layout"},
//    "poses": [{"capture": id, "corners": [[corner, camera column, row, projector column, row, d column / d camera
//       column, d column / d camera row, d row / d camera column, d row / d camera row, projector sigma], ...],
//       "unlit": [[corner, camera column, row], ...]}],
//    "left_out": [{"capture", "reason"}]}
//
// Corners are numbered row * columns + column; all else is in pixels. "unlit": without a projector coordinate.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "calibrate/observations.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::calibrate {

// Error: kFileNotWritten.
Result<void> write_observations(const std::filesystem::path& path, const Observations& observations);

// Errors: as contract_io::read_file; kFormatInvalid, kMemberMissing, kValueOutOfRange, kVersionUnsupported.
Result<Observations> read_observations(const std::filesystem::path& path, contract_io::Warnings& warnings);

}  // namespace beltpick::calibrate
