#include "app/model_hub.hpp"

#include <malloc.h>

#include <algorithm>

namespace beltpick::app {

namespace {

bool same_items(const std::vector<service::ItemInUse>& a, const std::vector<service::ItemInUse>& b) {
  // Version 0 is a file, which may have changed.
  const auto same = [](const service::ItemInUse& x, const service::ItemInUse& y) {
    return x.id == y.id && x.version == y.version && x.version != 0;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

}  // namespace

ModelHub::ModelHub(Arena& arena, const Settings& settings, Log& log)
    : settings_(settings),
      log_(log),
      files_(settings),
      source_(&files_),
      stores_{pipeline::ModelStore(arena, settings.limits), pipeline::ModelStore(arena, settings.limits)} {}

void ModelHub::use(const ModelSource& source, RecipeMemory memory) {
  source_ = &source;
  memory_ = std::move(memory);
  active_ = memory_.number();
}

Result<void> ModelHub::load() {
  prepare();
  const Result<void> outcome = *candidate_;
  change();
  return outcome;
}

// Reads what is wanted and, where that is not what is in use already, builds it in the standby half.
void ModelHub::prepare() {
  std::vector<std::string> warnings;
  auto half = read(warnings);
  tell(warnings);
  standby_is_new_ = half && !in_use_already(*half);
  candidate_ = half ? Result<void>{} : Result<void>(std::unexpected(half.error()));
  if (standby_is_new_) {
    candidate_ = stores_[standby()].load(half->recipe.templates, settings_.gripper);
    halves_[standby()] = std::move(*half);
  }
  ::malloc_trim(0);  // what reading took would otherwise stay resident for good
}

Result<ModelHub::Half> ModelHub::read(std::vector<std::string>& warnings) {
  const auto listed = list_recipes(*source_, warnings);
  if (listed) {
    std::vector<std::uint16_t> numbers;
    for (const ListedRecipe& each : *listed) numbers.push_back(each.recipe.number);
    numbers_.set(numbers);
  }
  auto geometry = load_geometry(*source_, settings_, warnings);
  tell_calibration(geometry);
  if (!geometry) return std::unexpected(geometry.error());
  if (!listed) return std::unexpected(listed.error());
  const auto number = choose(*listed);
  if (!number) return std::unexpected(number.error());
  const auto chosen = std::find_if(listed->begin(), listed->end(),
                                   [&](const ListedRecipe& each) { return each.recipe.number == *number; });
  auto recipe = load_recipe(*chosen, *source_, settings_, geometry->calibration, warnings);
  if (!recipe) return std::unexpected(recipe.error());
  return Half{std::move(*geometry), std::move(*recipe)};
}

// What was selected, now or before the restart; before anything was, what the configuration says, or the first.
Result<std::uint16_t> ModelHub::choose(const std::vector<ListedRecipe>& listed) const {
  if (listed.empty()) return failure(ResultCode::kRecipeUnknown, "expected a recipe, found none; upload one");
  const std::uint16_t selected = active_;
  const std::uint16_t wanted = selected != 0 ? selected : static_cast<std::uint16_t>(settings_.recipe);
  if (wanted == 0) return listed.front().recipe.number;
  const auto is_wanted = [&](const ListedRecipe& each) { return each.recipe.number == wanted; };
  if (std::any_of(listed.begin(), listed.end(), is_wanted)) return wanted;
  return failure(ResultCode::kRecipeUnknown, "%s: expected the number of a recipe, found %u; select or upload one",
                 selected != 0 ? "the selected recipe" : "model.recipe", wanted);
}

bool ModelHub::in_use_already(const Half& half) const {
  return whole_ && same_items(half.geometry.items, active().geometry.items) &&
         same_items(half.recipe.items, active().recipe.items);
}

// Nothing in use is touched by what was asked for.
void ModelHub::keep() {
  candidate_.reset();
  announce_ = holding_ = false;
  served_ = prepared_for_;
}

// Neither capture nor pipeline runs.
void ModelHub::change() {
  if (*candidate_ && standby_is_new_) {
    Half& next = halves_[standby()];
    if (adopt_) candidate_ = adopt_(next.geometry, next.recipe);
    half_ = standby();
    whole_ = candidate_->has_value();
    halves_[standby()] = {};
    ::malloc_trim(0);
  }
  settle();
  keep();
}

void ModelHub::settle() {
  const Result<void>& outcome = *candidate_;
  load_code_ = outcome ? ResultCode::kOk : outcome.error().code;
  if (!outcome) {
    log_.code(LogLevel::kFault, "no cycle can be started", outcome.error().code);
    log_.write(LogLevel::kFault, "%s", outcome.error().detail);
  } else {
    const LoadedRecipe& in_use = recipe();
    std::uint16_t none = 0;  // but for the first time it is what was asked for, and perhaps another by now
    active_.compare_exchange_strong(none, in_use.recipe.number);
    capture_time_us_ = in_use.plan.duration_us;
    log_.write(LogLevel::kInfo, "recipe %u '%s': %zu frames, %zu templates", in_use.recipe.number,
               in_use.recipe.name.c_str(), in_use.sequence.frames.size(), in_use.templates.size());
  }
  if (const auto kept = memory_.remember(active_); !kept) {
    log_.write(LogLevel::kWarning, "the selected recipe would not survive a restart: %s", kept.error().detail);
  }
  tell_in_use(outcome);
}

void ModelHub::tell_calibration(const Result<Geometry>& geometry) {
  const std::lock_guard lock(in_use_mutex_);
  in_use_.calibration_problem = geometry ? Error{} : geometry.error();
  in_use_.calibration_id = geometry ? geometry->calibration.id : "";
  in_use_.calibration_camera = geometry ? geometry->calibration.camera_serial : "";
}

void ModelHub::tell_in_use(const Result<void>& outcome) {
  const std::lock_guard lock(in_use_mutex_);
  in_use_.problem = outcome ? Error{} : outcome.error();
  if (!outcome) return;
  const LoadedRecipe& loaded = recipe();
  in_use_.recipe = loaded.recipe.number;
  in_use_.recipe_name = loaded.recipe.name;
  in_use_.frames = static_cast<int>(loaded.sequence.frames.size());
  in_use_.templates = static_cast<int>(loaded.templates.size());
  in_use_.items = geometry().items;
  in_use_.items.insert(in_use_.items.end(), loaded.items.begin(), loaded.items.end());
}

void ModelHub::serve(const std::function<bool()>& workers_idle) {
  const bool reload = reload_.exchange(false);
  const std::uint32_t asked = asked_;  // before the recipe that was asked for is looked at
  if (reload || asked != prepared_for_) {
    announce_ = announce_ || reload;
    prepared_for_ = asked;
    prepare();
    if (*candidate_ && !standby_is_new_ && load_code_ == ResultCode::kOk) return keep();
    if (announce_ && !holding_) {  // told once, nothing is offered until the change
      holding_ = true;             // before `changed`: no capture may start between the two
      changed_ = true;
    }
  }
  if (!candidate_ || changed_ || reload_ || asked_ != prepared_for_ || !workers_idle()) return;
  change();
}

void ModelHub::check_camera(const std::string& serial) {
  if (serial.empty() || !idle()) return;
  {
    const std::lock_guard lock(in_use_mutex_);
    in_use_.camera_serial = serial;
  }
  const auto good = load_code_ == ResultCode::kOk ? check_serial(geometry().calibration, serial) : Result<void>{};
  const bool wrong = !good;
  if (wrong && !wrong_camera_) log_.write(LogLevel::kFault, "%s", good.error().detail);
  wrong_camera_ = wrong;
}

ResultCode ModelHub::code() const {
  const ResultCode load = load_code_;
  return load == ResultCode::kOk && wrong_camera_ ? ResultCode::kCalibrationMismatch : load;
}

void ModelHub::select_recipe(std::uint16_t number) {
  active_ = number;
  ++asked_;
}

OfferFrame ModelHub::offer_frame() const {
  const Cell& cell = geometry().cell;
  if (cell.T_robot_camera) return {PoseFrame::kRobot, *cell.T_robot_camera};
  if (!cell.T_belt_camera) return {};
  const auto& belt = *cell.T_belt_camera;
  return {PoseFrame::kBelt, {belt.rotation, belt.translation_mm}};
}

const Grasp* ModelHub::grasp(int template_index, int grasp_index) const {
  const auto& templates = recipe().templates;
  if (template_index < 0 || template_index >= static_cast<int>(templates.size())) return nullptr;
  const auto& grasps = templates[static_cast<std::size_t>(template_index)].grasps;
  if (grasp_index < 0 || grasp_index >= static_cast<int>(grasps.size())) return nullptr;
  return &grasps[static_cast<std::size_t>(grasp_index)];
}

ModelHub::InUse ModelHub::in_use() const {
  const std::lock_guard lock(in_use_mutex_);
  return in_use_;
}

void ModelHub::tell(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) log_.write(LogLevel::kWarning, "%s", warning.c_str());
}

}  // namespace beltpick::app
