// What a cell works with, read and judged, ready to be run: calibration and cell, and a recipe with everything that it
// names. Loading for use and judging an upload are the same functions.
#pragma once

#include <string>
#include <vector>

#include "app/model_source.hpp"
#include "app/settings.hpp"
#include "base/result.hpp"
#include "capture/capture_plan.hpp"
#include "contract/calibration.hpp"
#include "contract/part_template.hpp"
#include "contract/recipe.hpp"
#include "decode/plan.hpp"
#include "projector/projector.hpp"
#include "service/cell_side.hpp"

namespace beltpick::app {

struct Geometry {
  Calibration calibration;
  Cell cell;
  std::vector<service::ItemInUse> items;  // what it was read from
};

// Of the configured image size, of a geometry that a cell can have; the cell file of this calibration. Errors: those of
// reading; kNoCalibration, kCalibrationMismatch, kValueOutOfRange.
Result<Calibration> load_calibration(const ModelDocument& document, const Settings& settings,
                                     std::vector<std::string>& warnings);
Result<Cell> load_cell(const ModelDocument& document, const Calibration& calibration,
                       std::vector<std::string>& warnings);
Result<Geometry> load_geometry(const ModelSource& source, const Settings& settings, std::vector<std::string>& warnings);

// Whether the calibration is of the camera that answers; good where either tells no serial number. Error:
// kCalibrationMismatch.
Result<void> check_serial(const Calibration& calibration, const std::string& camera_serial);

// A recipe that was read but for what it names.
struct ListedRecipe {
  Recipe recipe;
  service::ItemInUse item;
};
// All recipes there are. Errors: those of reading; kValueOutOfRange where two have the same number.
Result<std::vector<ListedRecipe>> list_recipes(const ModelSource& source, std::vector<std::string>& warnings);

struct LoadedRecipe {
  Recipe recipe;
  Sequence sequence;
  capture::CapturePlan plan;
  projector::ShowPlan show;
  decode::FoldPlan fold;
  std::vector<PartTemplate> templates;  // as the recipe orders them
  std::vector<service::ItemInUse> items;
};

// The sequence of `recipe` with this calibration, and what capturing and decoding it takes: `loaded` without its
// templates. Errors: kLimitExceeded (frames, decoding), kSequenceUndecodable, kCalibrationMismatch (projector),
// kValueOutOfRange (a timing that cannot be run); those of reading a sequence.
Result<LoadedRecipe> plan_recipe(const ListedRecipe& listed, const Settings& settings, const Calibration& calibration,
                                 std::vector<std::string>& warnings);

// With its templates. Errors: as above; those of reading; kLimitExceeded (number of templates), kTemplateTooLarge,
// kNoTemplate.
Result<LoadedRecipe> load_recipe(const ListedRecipe& listed, const ModelSource& source, const Settings& settings,
                                 const Calibration& calibration, std::vector<std::string>& warnings);

// Errors: those of reading; kTemplateTooLarge, kNoTemplate.
Result<PartTemplate> load_template(const ModelDocument& document, const Settings& settings);

}  // namespace beltpick::app
