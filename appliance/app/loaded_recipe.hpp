// A recipe with everything it names, read and judged, ready to be run.
#pragma once

#include <string>
#include <vector>

#include "app/settings.hpp"
#include "base/result.hpp"
#include "capture/capture_plan.hpp"
#include "contract/calibration.hpp"
#include "contract/part_template.hpp"
#include "contract/recipe.hpp"

namespace beltpick::app {

// Calibration and cell of the configuration. The calibration must be of the configured image size, the cell file of
// this calibration. Errors: those of reading; kCalibrationMismatch, kNoCalibration.
struct Geometry {
  Calibration calibration;
  Cell cell;
};
Result<Geometry> load_geometry(const Settings& settings, std::vector<std::string>& warnings);

struct LoadedRecipe {
  Recipe recipe;
  Sequence sequence;
  capture::CapturePlan plan;
  std::vector<PartTemplate> templates;  // as the recipe orders them
};

// Errors: those of reading; kLimitExceeded (frames), kValueOutOfRange (a timing that cannot be run), ...
Result<LoadedRecipe> load_recipe(const Recipe& recipe, const Settings& settings, const Calibration& calibration,
                                 std::vector<std::string>& warnings);

}  // namespace beltpick::app
