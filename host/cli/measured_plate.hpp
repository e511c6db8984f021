// One capture of the plate measured with a calibration: what `calibrate verify` and `calibrate belt` start from.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "board_options.hpp"
#include "calibrate/plate_check.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::cli {

// Errors: as board_of, read_plate and check_plate; kCalibrationMismatch where camera or projector of the capture are of
// another size than the calibration's. The message names the capture.
Result<calibrate::PlateCheck> measure_plate(const std::filesystem::path& path, const BoardOptions& board,
                                            const Calibration& calibration, const calibrate::PlateTolerance& tolerance,
                                            contract_io::Warnings& warnings, bool quiet);

}  // namespace beltpick::cli
