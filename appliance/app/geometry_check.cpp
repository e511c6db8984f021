#include "app/geometry_check.hpp"

#include <cmath>

#include "contract/result_codes.hpp"

namespace beltpick::app {

namespace {

// From a fisheye of 170 degrees to a telescope of 1 degree.
constexpr double kLeastFocal = 0.04, kMostFocal = 60.0;  // of the larger side of the image
constexpr double kMostAnisotropy = 3.0;                  // of the focal lengths; a diamond lattice has up to 2
constexpr double kMostShift = 2.0;                       // of the principal point, in image sides
constexpr double kMostDistortion = 1e4;
constexpr double kLeastBaseline_mm = 5, kMostBaseline_mm = 5000;
constexpr double kMostDistance_mm = 20'000;

Result<void> refuse(const std::string& source, const char* member, const std::string& expected, double found,
                    const char* remedy) {
  return failure(ResultCode::kValueOutOfRange, "%s: %s: expected %s, found %g; %s", source.c_str(), member,
                 expected.c_str(), found, remedy);
}

Result<void> check_lens(const Lens& lens, const std::string& source, const char* member) {
  constexpr const char* kRemedy = "calibrate again";
  const double side_px = std::max(lens.width, lens.height);
  for (const double focal_px : {lens.fx_px, lens.fy_px}) {
    if (focal_px >= kLeastFocal * side_px && focal_px <= kMostFocal * side_px) continue;
    return refuse(source, member, "a focal length of 0.04 to 60 times the image's larger side", focal_px, kRemedy);
  }
  const double ratio = lens.fx_px / lens.fy_px;
  if (ratio > kMostAnisotropy || ratio < 1.0 / kMostAnisotropy) {
    return refuse(source, member, "focal lengths alike within a factor of 3", ratio, kRemedy);
  }
  const double off_x = std::abs(lens.cx_px - 0.5 * lens.width) / lens.width;
  const double off_y = std::abs(lens.cy_px - 0.5 * lens.height) / lens.height;
  if (std::max(off_x, off_y) > kMostShift) {
    return refuse(source, member, "a principal point within two image sides of the centre", std::max(off_x, off_y),
                  kRemedy);
  }
  for (const double coefficient : lens.distortion) {
    if (std::abs(coefficient) <= kMostDistortion) continue;
    return refuse(source, member, "distortion coefficients of a lens", coefficient, kRemedy);
  }
  return {};
}

}  // namespace

Result<void> check_plausible(const Calibration& calibration, const std::string& source) {
  if (auto good = check_lens(calibration.camera, source, "camera"); !good) return good;
  if (auto good = check_lens(calibration.projector, source, "projector"); !good) return good;
  const double baseline_mm = calibration.T_projector_camera.translation_mm.norm();
  if (baseline_mm >= kLeastBaseline_mm && baseline_mm <= kMostBaseline_mm) return {};
  return refuse(source, "projector_from_camera.translation", "5 to 5000 mm between camera and projector", baseline_mm,
                "is it in mm? calibrate again");
}

Result<void> check_plausible(const Cell& cell, const std::string& source, std::vector<std::string>& warnings) {
  constexpr const char* kRemedy = "is it in mm? set the cell up again";
  if (cell.T_belt_camera) {
    const double away_mm = cell.T_belt_camera->translation_mm.norm();
    if (!(away_mm <= kMostDistance_mm)) {
      return refuse(source, "belt_from_camera", "a camera within 20 m of the belt's origin", away_mm, kRemedy);
    }
    const bool above = cell.T_belt_camera->translation_mm.z() > 0.0;
    const bool looks_down = cell.T_belt_camera->rotation(2, 2) < 0.0;
    if (!above || !looks_down) {
      warnings.push_back(source +
                         ": belt_from_camera: the camera does not look down on the belt (z is up): is it the " +
                         "pose of the camera in the belt's frame?");
    }
  }
  if (cell.T_robot_camera) {
    const double away_mm = cell.T_robot_camera->translation_mm.norm();
    if (!(away_mm <= kMostDistance_mm)) {
      return refuse(source, "robot_from_camera", "a camera within 20 m of the robot's base", away_mm, kRemedy);
    }
  }
  return {};
}

}  // namespace beltpick::app
