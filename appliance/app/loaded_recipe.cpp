#include "app/loaded_recipe.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/recipe_io.hpp"
#include "contract_io/template_io.hpp"

namespace beltpick::app {

namespace {

capture::CaptureTiming timing_of(const Recipe& recipe, const Settings& settings) {
  capture::CaptureTiming timing;
  timing.exposure_us = recipe.exposure_us;
  timing.settle_us = static_cast<std::uint32_t>(recipe.settle_us);
  timing.period_us = static_cast<std::uint32_t>(recipe.period_us);
  timing.readout_us = static_cast<std::uint32_t>(settings.readout_us);
  timing.strobe_tolerance_us = static_cast<std::uint32_t>(settings.strobe_tolerance_us);
  return timing;
}

Result<void> check_sizes(const Calibration& calibration, const Settings& settings) {
  const Lens& camera = calibration.camera;
  const Limits& limits = settings.limits;
  if (camera.width == limits.image_width && camera.height == limits.image_height) return {};
  return failure(ResultCode::kCalibrationMismatch,
                 "%s: camera: expected the configured %dx%d, found %dx%d; calibrate this camera, or set "
                 "limits.image_width and limits.image_height",
                 settings.calibration.c_str(), limits.image_width, limits.image_height, camera.width, camera.height);
}

}  // namespace

Result<Geometry> load_geometry(const Settings& settings, std::vector<std::string>& warnings) {
  if (settings.calibration.empty()) {
    return failure(ResultCode::kNoCalibration, "model.calibration: expected a file, found none; calibrate and name it");
  }
  auto calibration = contract_io::read_calibration(from_settings(settings, settings.calibration), warnings);
  if (!calibration) return std::unexpected(calibration.error());
  if (const auto sizes = check_sizes(*calibration, settings); !sizes) return std::unexpected(sizes.error());
  if (settings.cell.empty()) return Geometry{std::move(*calibration), {}};
  auto cell = contract_io::read_cell(from_settings(settings, settings.cell), warnings);
  if (!cell) return std::unexpected(cell.error());
  if (!cell->calibration_id.empty() && !calibration->id.empty() && cell->calibration_id != calibration->id) {
    return failure(ResultCode::kCalibrationMismatch,
                   "%s: calibration_id: expected '%s', the calibration's, found '%s'; set the cell up again",
                   settings.cell.c_str(), calibration->id.c_str(), cell->calibration_id.c_str());
  }
  return Geometry{std::move(*calibration), std::move(*cell)};
}

Result<LoadedRecipe> load_recipe(const Recipe& recipe, const Settings& settings, const Calibration& calibration,
                                 std::vector<std::string>& warnings) {
  LoadedRecipe loaded{recipe, {}, {}, {}};
  ProjectorGrid projector{calibration.projector.width, calibration.projector.height};
  if (settings.projector_layout == "diamond") projector.layout = ProjectorLayout::kDiamond;
  auto sequence = contract_io::recipe_sequence(recipe, projector, warnings);
  if (!sequence) return std::unexpected(sequence.error());
  loaded.sequence = std::move(*sequence);
  const auto frames = static_cast<int>(loaded.sequence.frames.size());
  if (frames > settings.limits.frames) {
    return failure(ResultCode::kLimitExceeded,
                   "recipe %u: sequence: expected at most %d frames, found %d; raise limits.frames", recipe.number,
                   settings.limits.frames, frames);
  }
  auto plan = capture::make_plan(loaded.sequence, timing_of(recipe, settings));
  if (!plan) return std::unexpected(plan.error());
  loaded.plan = std::move(*plan);
  for (const std::string& path : recipe.templates) {
    auto part = contract_io::read_template(path);
    if (!part) return std::unexpected(part.error());
    loaded.templates.push_back(std::move(*part));
  }
  return loaded;
}

}  // namespace beltpick::app
