#include "app/loaded_recipe.hpp"

#include <algorithm>
#include <span>

#include "app/geometry_check.hpp"
#include "app/projector_choice.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/recipe_io.hpp"
#include "contract_io/template_io.hpp"
#include "pipeline/measure.hpp"
#include "pipeline/model_store.hpp"

namespace beltpick::app {

namespace {

capture::CaptureTiming timing_of(const Recipe& recipe, const Settings& settings) {
  capture::CaptureTiming timing;
  timing.exposure_us = recipe.exposure_us;
  timing.settle_us = static_cast<std::uint32_t>(recipe.settle_us);
  timing.period_us = static_cast<std::uint32_t>(recipe.period_us);
  timing.readout_us = static_cast<std::uint32_t>(settings.readout_us);
  timing.overlap_gap_us = static_cast<std::uint16_t>(settings.overlap_gap_us);
  timing.strobe_tolerance_us = static_cast<std::uint32_t>(settings.strobe_tolerance_us);
  return timing;
}

Result<void> check_sizes(const Calibration& calibration, const Settings& settings, const std::string& source) {
  const Lens& camera = calibration.camera;
  const Limits& limits = settings.limits;
  if (camera.width == limits.image_width && camera.height == limits.image_height) return {};
  return failure(ResultCode::kCalibrationMismatch,
                 "%s: camera: expected the configured %dx%d, found %dx%d; calibrate this camera, or set "
                 "limits.image_width and limits.image_height",
                 source.c_str(), limits.image_width, limits.image_height, camera.width, camera.height);
}

Result<void> check_frames(const LoadedRecipe& loaded, const Settings& settings) {
  const auto frames = static_cast<int>(loaded.sequence.frames.size());
  if (frames <= settings.limits.frames) return {};
  return failure(ResultCode::kLimitExceeded,
                 "recipe %u: sequence: expected at most %d frames, found %d; raise limits.frames", loaded.recipe.number,
                 settings.limits.frames, frames);
}

// What the trigger is armed with and what the projector shows, made to fit each other.
Result<void> plan_capture(LoadedRecipe& loaded, const Settings& settings) {
  const auto periods_us = projector_periods_us(settings, loaded.sequence, loaded.recipe.settle_us);
  if (!periods_us) return std::unexpected(periods_us.error());
  capture::CaptureTiming timing = timing_of(loaded.recipe, settings);
  timing.least_period_us = *periods_us;
  auto plan = capture::make_plan(loaded.sequence, timing);
  if (!plan) return std::unexpected(plan.error());
  loaded.plan = std::move(*plan);
  const std::span groups(loaded.plan.timing.groups, loaded.plan.timing.group_count);
  const auto shortest = std::ranges::min_element(groups, {}, &protocol::Group::period_us);
  loaded.show = {loaded.sequence, timing.settle_us, shortest->period_us};
  return check_projector_timing(settings, loaded.show);
}

}  // namespace

Result<LoadedRecipe> plan_recipe(const ListedRecipe& listed, const Settings& settings, const Calibration& calibration,
                                 std::vector<std::string>& warnings) {
  LoadedRecipe loaded;
  loaded.recipe = listed.recipe;
  loaded.items.push_back(listed.item);
  const ProjectorGrid projector{calibration.projector.width, calibration.projector.height, projector_layout(settings)};
  auto sequence = contract_io::recipe_sequence(loaded.recipe, projector, warnings);
  if (!sequence) return std::unexpected(sequence.error());
  loaded.sequence = std::move(*sequence);
  if (auto few = check_frames(loaded, settings); !few) return std::unexpected(few.error());
  if (const auto timed = plan_capture(loaded, settings); !timed) return std::unexpected(timed.error());
  auto fold = pipeline::plan_measuring(loaded.sequence, calibration, pipeline::decoder_limits(settings.limits));
  if (!fold) return std::unexpected(fold.error());
  loaded.fold = std::move(*fold);
  return loaded;
}

Result<Calibration> load_calibration(const ModelDocument& document, const Settings& settings,
                                     std::vector<std::string>& warnings) {
  auto calibration = contract_io::parse_calibration(document.bytes, document.source, warnings);
  if (!calibration) return calibration;
  if (const auto sizes = check_sizes(*calibration, settings, document.source); !sizes) {
    return std::unexpected(sizes.error());
  }
  if (const auto good = check_plausible(*calibration, document.source); !good) return std::unexpected(good.error());
  return calibration;
}

Result<Cell> load_cell(const ModelDocument& document, const Calibration& calibration,
                       std::vector<std::string>& warnings) {
  if (document.bytes.empty() && document.source.empty()) return Cell{};
  auto cell = contract_io::parse_cell(document.bytes, document.source, warnings);
  if (!cell) return cell;
  if (!cell->calibration_id.empty() && !calibration.id.empty() && cell->calibration_id != calibration.id) {
    return failure(ResultCode::kCalibrationMismatch,
                   "%s: calibration_id: expected '%s', the calibration's, found '%s'; set the cell up again",
                   document.source.c_str(), contract_io::one_line(calibration.id).c_str(),
                   contract_io::one_line(cell->calibration_id).c_str());
  }
  if (const auto good = check_plausible(*cell, document.source, warnings); !good) return std::unexpected(good.error());
  return cell;
}

Result<Geometry> load_geometry(const ModelSource& source, const Settings& settings,
                               std::vector<std::string>& warnings) {
  Geometry geometry;
  const auto calibration_id = item_id(ItemKind::kCalibration), cell_id = item_id(ItemKind::kCell);
  const auto calibration_file = source.get(calibration_id);
  if (!calibration_file) return std::unexpected(calibration_file.error());
  auto calibration = load_calibration(*calibration_file, settings, warnings);
  if (!calibration) return std::unexpected(calibration.error());
  geometry.calibration = std::move(*calibration);
  geometry.items.push_back({calibration_id, calibration_file->version});

  const auto cell_file = source.get(cell_id);
  if (!cell_file) return std::unexpected(cell_file.error());
  auto cell = load_cell(*cell_file, geometry.calibration, warnings);
  if (!cell) return std::unexpected(cell.error());
  geometry.cell = std::move(*cell);
  if (!cell_file->source.empty()) geometry.items.push_back({cell_id, cell_file->version});
  return geometry;
}

Result<void> check_serial(const Calibration& calibration, const std::string& camera_serial) {
  const std::string& expected = calibration.camera_serial;
  if (expected.empty() || camera_serial.empty() || expected == camera_serial) return {};
  return failure(ResultCode::kCalibrationMismatch,
                 "calibration: camera_serial: expected '%s', that of the camera that answers, found '%s'; calibrate "
                 "this camera",
                 contract_io::one_line(camera_serial).c_str(), contract_io::one_line(expected).c_str());
}

Result<std::vector<ListedRecipe>> list_recipes(const ModelSource& source, std::vector<std::string>& warnings) {
  std::vector<ListedRecipe> listed;
  for (const std::string& name : source.recipes()) {
    const auto id = item_id(ItemKind::kRecipe, name);
    const auto document = source.get(id);
    if (!document && document.error().code == ResultCode::kChecksumWrong) {
      warnings.push_back(std::string(document.error().text()) + "; the other recipes can be run");
      continue;
    }
    if (!document) return std::unexpected(document.error());
    auto recipe = source.parse(*document, warnings);
    if (!recipe) return std::unexpected(recipe.error());
    const auto same = [&](const ListedRecipe& other) { return other.recipe.number == recipe->number; };
    const auto at = std::find_if(listed.begin(), listed.end(), same);
    if (at != listed.end()) {
      return failure(ResultCode::kValueOutOfRange,
                     "%s: number: expected one that no other recipe has, found %u, that of recipe '%s'; choose another",
                     document->source.c_str(), recipe->number, contract_io::one_line(at->item.id.name).c_str());
    }
    listed.push_back({std::move(*recipe), {id, document->version}});
  }
  return listed;
}

Result<PartTemplate> load_template(const ModelDocument& document, const Settings& settings) {
  auto part = contract_io::parse_template(document.bytes, document.name, contract_io::one_line(document.source));
  if (!part) return part;
  if (const auto fits = pipeline::check_template(*part, settings.limits); !fits) return std::unexpected(fits.error());
  return part;
}

Result<LoadedRecipe> load_recipe(const ListedRecipe& listed, const ModelSource& source, const Settings& settings,
                                 const Calibration& calibration, std::vector<std::string>& warnings) {
  auto loaded = plan_recipe(listed, settings, calibration, warnings);
  if (!loaded) return loaded;
  for (const std::string& name : listed.recipe.templates) {
    const auto id = item_id(ItemKind::kTemplate, name);
    const auto document = source.get(id);
    if (!document) return std::unexpected(document.error());
    auto part = load_template(*document, settings);
    if (!part) return std::unexpected(part.error());
    loaded->templates.push_back(std::move(*part));
    loaded->items.push_back({id, document->version});
  }
  if (const auto fit = pipeline::check_templates(loaded->templates, settings.limits); !fit) {
    return std::unexpected(fit.error());
  }
  return loaded;
}

}  // namespace beltpick::app
