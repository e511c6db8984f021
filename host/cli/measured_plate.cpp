#include "measured_plate.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "plate_capture.hpp"

namespace beltpick::cli {
namespace {

Result<void> check_rig(const PlateCapture& plate, const Calibration& calibration, const std::string& name) {
  const Lens& camera = calibration.camera;
  const Lens& projector = calibration.projector;
  if (plate.camera_width == camera.width && plate.camera_height == camera.height &&
      plate.projector.width == projector.width && plate.projector.height == projector.height) {
    return {};
  }
  return failure(
      ResultCode::kCalibrationMismatch,
      "%s: the calibration is of a camera of %dx%d and a projector of %dx%d, the capture of %dx%d and %dx%d; use "
      "the calibration of this rig and region",
      name.c_str(), camera.width, camera.height, projector.width, projector.height, plate.camera_width,
      plate.camera_height, plate.projector.width, plate.projector.height);
}

}  // namespace

Result<calibrate::PlateCheck> measure_plate(const std::filesystem::path& path, const BoardOptions& options,
                                            const Calibration& calibration, const calibrate::PlateTolerance& tolerance,
                                            contract_io::Warnings& warnings, bool quiet) {
  const auto board = board_of(options);
  if (!board) return std::unexpected(board.error());
  const auto plate = read_plate(path, *board, warnings, quiet);
  if (!plate) return std::unexpected(plate.error());
  const std::string name = contract_io::one_line(path.string());
  if (auto same = check_rig(*plate, calibration, name); !same) return std::unexpected(same.error());
  auto check =
      calibrate::check_plate(calibration, calibrate::seen_corners(*board, plate->pose), board->square_mm, tolerance);
  if (!check) return failure(check.error().code, "%s: %s", name.c_str(), check.error().detail);
  return check;
}

}  // namespace beltpick::cli
