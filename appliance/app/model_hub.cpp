#include "app/model_hub.hpp"

#include <malloc.h>

#include <algorithm>

#include "contract_io/recipe_io.hpp"

namespace beltpick::app {

ModelHub::ModelHub(Arena& arena, const Settings& settings, Log& log)
    : settings_(settings), log_(log), store_(arena, settings.limits) {}

Result<void> ModelHub::load() {
  contract_io::Warnings warnings;
  const auto outcome = [&]() -> Result<void> {
    auto geometry = load_geometry(settings_, warnings);
    if (!geometry) return std::unexpected(geometry.error());
    geometry_ = std::move(*geometry);
    if (const auto read = read_recipes(); !read) return read;
    return load_active();
  }();
  for (const std::string& warning : warnings) log_.write(LogLevel::kWarning, "%s", warning.c_str());
  return settle(outcome);
}

Result<void> ModelHub::read_recipes() {
  contract_io::Warnings warnings;
  std::vector<Recipe> recipes;
  for (const std::string& path : settings_.recipes) {
    auto recipe = contract_io::read_recipe(from_settings(settings_, path), warnings);
    if (!recipe) return std::unexpected(recipe.error());
    const auto same = [&](const Recipe& other) { return other.number == recipe->number; };
    if (std::any_of(recipes.begin(), recipes.end(), same)) {
      return failure(ResultCode::kValueOutOfRange, "%s: number: expected one that no other recipe has, found %u",
                     path.c_str(), recipe->number);
    }
    recipes.push_back(std::move(*recipe));
  }
  for (const std::string& warning : warnings) log_.write(LogLevel::kWarning, "%s", warning.c_str());
  {
    const std::lock_guard lock(recipes_mutex_);
    recipes_ = std::move(recipes);
  }
  if (active_ != 0 && knows_recipe(active_)) return {};
  const auto wanted = static_cast<std::uint16_t>(settings_.recipe);
  if (wanted != 0 && !knows_recipe(wanted)) {
    return failure(ResultCode::kRecipeUnknown, "model.recipe: expected the number of a recipe, found %u", wanted);
  }
  active_ = wanted != 0 ? wanted : recipes_.front().number;
  return {};
}

Result<void> ModelHub::load_active() {
  const auto is_active = [&](const Recipe& recipe) { return recipe.number == active_; };
  const auto recipe = std::find_if(recipes_.begin(), recipes_.end(), is_active);
  if (recipe == recipes_.end()) return failure(ResultCode::kRecipeUnknown, "recipe %u is not there", active_.load());
  contract_io::Warnings warnings;
  auto loaded = load_recipe(*recipe, settings_, geometry_.calibration, warnings);
  for (const std::string& warning : warnings) log_.write(LogLevel::kWarning, "%s", warning.c_str());
  if (!loaded) return std::unexpected(loaded.error());
  if (const auto stored = store_.load(loaded->templates, settings_.gripper); !stored) return stored;
  loaded_ = std::move(*loaded);
  ::malloc_trim(0);  // what reading took would otherwise stay resident for good
  capture_time_us_ = loaded_.plan.duration_us;
  return adopt_ ? adopt_(geometry_, loaded_) : Result<void>{};
}

Result<void> ModelHub::settle(const Result<void>& outcome) {
  code_ = outcome ? ResultCode::kOk : outcome.error().code;
  wrong_camera_ = false;
  checked_serial_.clear();
  if (!outcome) {
    log_.code(LogLevel::kFault, "no cycle can be started", outcome.error().code);
    log_.write(LogLevel::kFault, "%s", outcome.error().detail);
  } else {
    log_.write(LogLevel::kInfo, "recipe %u '%s': %zu frames, %zu templates", active_.load(),
               loaded_.recipe.name.c_str(), loaded_.sequence.frames.size(), loaded_.templates.size());
  }
  return outcome;
}

void ModelHub::serve(bool workers_idle) {
  if (!wants_to_load() || !workers_idle) return;
  if (reload_.exchange(false)) {
    (void)load();  // what is wrong is in code()
  } else {
    (void)settle(load_active());
  }
  busy_ = false;
}

void ModelHub::check_camera(const std::string& serial) {
  if (busy_ || serial.empty() || serial == checked_serial_) return;
  checked_serial_ = serial;
  const std::string& expected = geometry_.calibration.camera_serial;
  const bool other = !expected.empty() && expected != serial;
  if (other) {
    log_.write(LogLevel::kFault,
               "%s: camera_serial: expected '%s', the camera that answers is '%s'; calibrate this camera",
               settings_.calibration.c_str(), expected.c_str(), serial.c_str());
  }
  if (other && code_ == ResultCode::kOk) {
    code_ = ResultCode::kCalibrationMismatch;
    wrong_camera_ = true;
  } else if (!other && wrong_camera_) {
    code_ = ResultCode::kOk;
    wrong_camera_ = false;
  }
}

void ModelHub::reload() {
  reload_ = true;
  busy_ = true;  // before `changed`: no capture may start between the two
  changed_ = true;
}

bool ModelHub::knows_recipe(std::uint16_t number) const {
  const std::lock_guard lock(recipes_mutex_);
  return std::any_of(recipes_.begin(), recipes_.end(), [&](const Recipe& recipe) { return recipe.number == number; });
}

void ModelHub::select_recipe(std::uint16_t number) {
  active_ = number;
  busy_ = true;
}

OfferFrame ModelHub::offer_frame() const {
  const Cell& cell = geometry_.cell;
  if (cell.T_robot_camera) return {PoseFrame::kRobot, *cell.T_robot_camera};
  if (!cell.T_belt_camera) return {};
  const auto& belt = *cell.T_belt_camera;
  return {PoseFrame::kBelt, {belt.rotation, belt.translation_mm}};
}

const Grasp* ModelHub::grasp(int template_index, int grasp_index) const {
  const auto& templates = loaded_.templates;
  if (template_index < 0 || template_index >= static_cast<int>(templates.size())) return nullptr;
  const auto& grasps = templates[static_cast<std::size_t>(template_index)].grasps;
  if (grasp_index < 0 || grasp_index >= static_cast<int>(grasps.size())) return nullptr;
  return &grasps[static_cast<std::size_t>(grasp_index)];
}

}  // namespace beltpick::app
