#include "sequence_forecast.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "base/camera_noise.hpp"
#include "calibrate/triangulate.hpp"
#include "contract/lens_project.hpp"
#include "contract/result_codes.hpp"
#include "decode/plan.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/rig_calibration.hpp"

namespace beltpick::cli {
namespace {

// A matt surface at the default exposure, an ordinary one, a dark or steep one.
constexpr std::array<double, 3> kModulations{85.0, 60.0, 20.0};
constexpr double kMeanOverModulation = 1.1;

double coordinate(const PixelPosition& position, Axis axis) {
  return axis == Axis::kColumn ? position.column_px : position.row_px;
}

double depth_per_px(const WorkingPoint& at, Axis axis) {
  const auto code_at = [&](double z_mm) {
    return coordinate(project(at.calibration.projector, at.calibration.T_projector_camera * Vec3(z_mm * at.ray)), axis);
  };
  const double step_mm = 1e-3 * at.distance_mm;
  const double px = std::abs(code_at(at.distance_mm + step_mm) - code_at(at.distance_mm - step_mm));
  return 2.0 * step_mm / std::max(px, 1e-9);
}

// The same light from an image of other pixels.
void resize(Lens& lens, const ProjectorGrid& projector) {
  const double across = static_cast<double>(projector.width) / lens.width;
  const double down = static_cast<double>(projector.height) / lens.height;
  lens.fx_px *= across;
  lens.fy_px *= down;
  lens.cx_px = (lens.cx_px + 0.5) * across - 0.5;
  lens.cy_px = (lens.cy_px + 0.5) * down - 0.5;
  lens.width = projector.width;
  lens.height = projector.height;
}

Result<WorkingPoint> on_middle_ray(const Calibration& calibration, double distance_mm) {
  const Lens& camera = calibration.camera;
  const auto ray = calibrate::ray_of(camera, {0.5 * (camera.width - 1), 0.5 * (camera.height - 1)});
  if (ray) return WorkingPoint{calibration, distance_mm, *ray};
  return failure(ResultCode::kValueOutOfRange,
                 "calibration: the camera's distortion folds over before the middle of its image; expected a lens that "
                 "sees it; calibrate again");
}

const char* name_of(Axis axis) { return axis == Axis::kColumn ? "column" : "row"; }

}  // namespace

double AxisForecast::sigma_mm(double modulation) const {
  const double level = std::sqrt(kCameraNoise.variance(static_cast<float>(kMeanOverModulation * modulation)));
  const auto slope_px = static_cast<double>(noise.slope_px);
  return mm_per_px * std::hypot(static_cast<double>(noise.floor_px), slope_px * level / modulation);
}

Result<WorkingPoint> default_working_point(const ProjectorGrid& projector) {
  virtual_cell::RigOptions options;
  options.layout = projector.layout;
  const auto rig = virtual_cell::make_rig(options);
  if (!rig) return std::unexpected(rig.error());
  Calibration calibration = virtual_cell::calibrate_rig(*rig).calibration;
  resize(calibration.projector, projector);
  return on_middle_ray(calibration, options.camera_distance_mm);
}

Result<WorkingPoint> working_point(const Calibration& calibration, double distance_mm) {
  const auto crossing_mm = calibrate::crossing_depth_mm(calibration);
  if (distance_mm > 0.0 || crossing_mm) {
    return on_middle_ray(calibration, distance_mm > 0.0 ? distance_mm : *crossing_mm);
  }
  return failure(ResultCode::kValueOutOfRange,
                 "calibration: the middle of the camera's image never meets the middle of the projector's light in "
                 "front of them; give --distance-mm");
}

Result<SequenceForecast> forecast(const Sequence& sequence, const FrameTiming& timing, double load_us,
                                  const WorkingPoint& at) {
  const auto plan = decode::make_fold_plan(sequence);
  if (!plan) return std::unexpected(plan.error());
  SequenceForecast result;
  result.frames = static_cast<int>(sequence.frames.size());
  result.time_ms = 1e-3 * (result.frames * timing.frame_us() + load_us);
  result.state_bytes8 = plan->state_bytes(1);
  result.state_bytes16 = plan->state_bytes(2);
  result.distance_mm = at.distance_mm;
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    if (plan->codes(axis)) result.axes.push_back({axis, decode::code_noise(*plan, axis), depth_per_px(at, axis)});
  }
  return result;
}

std::string forecast_text(const SequenceForecast& forecast, const FrameTiming& timing) {
  char line[240];
  std::snprintf(line, sizeof line,
                "%d frames: %.0f ms at %g frames a second; the decoder keeps %d bytes a pixel (%d "
                "for a camera of 16 bits)\n",
                forecast.frames, forecast.time_ms, 1e6 / timing.frame_us(), forecast.state_bytes8,
                forecast.state_bytes16);
  std::string text = line;
  for (const AxisForecast& axis : forecast.axes) {
    std::snprintf(line, sizeof line,
                  "noise of the depth by %ss, %.0f mm from the camera (%.3f mm for a projector pixel):",
                  name_of(axis.axis), forecast.distance_mm, axis.mm_per_px);
    text += line;
    for (const double modulation : kModulations) {
      std::snprintf(line, sizeof line, "%s %.3f mm where the modulation is %.0f",
                    modulation == kModulations.front() ? "" : ",", axis.sigma_mm(modulation), modulation);
      text += line;
    }
    text += " grey levels of 255\n";
  }
  return text;
}

contract_io::Json forecast_json(const SequenceForecast& forecast, const FrameTiming& timing) {
  contract_io::Json axes = contract_io::Json::array();
  for (const AxisForecast& axis : forecast.axes) {
    contract_io::Json noise = contract_io::Json::array();
    for (const double modulation : kModulations) {
      noise.push_back({{"modulation", modulation}, {"sigma_mm", axis.sigma_mm(modulation)}});
    }
    axes.push_back({{"axis", name_of(axis.axis)}, {"mm_per_px", axis.mm_per_px}, {"noise", noise}});
  }
  return {{"time_ms", forecast.time_ms},
          {"frame_us", timing.frame_us()},
          {"decoder_bytes_per_pixel", forecast.state_bytes8},
          {"decoder_bytes_per_pixel_16_bit", forecast.state_bytes16},
          {"distance_mm", forecast.distance_mm},
          {"axes", axes}};
}

}  // namespace beltpick::cli
