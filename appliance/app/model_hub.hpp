// ModelHub: calibration, cell, recipes and templates in use. Loads at start, when the PLC selects another recipe, and
// when told that files have changed; the loading is done by the service thread while neither capture nor pipeline runs.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "app/loaded_recipe.hpp"
#include "app/log.hpp"
#include "app/models.hpp"
#include "pipeline/model_store.hpp"

namespace beltpick::app {

class ModelHub : public Models {
 public:
  // Takes the memory of the template models from the arena.
  ModelHub(Arena& arena, const Settings& settings, Log& log);

  // What waits for new models, called while nothing runs. An error makes the recipe unusable.
  using Adopt = std::function<Result<void>(const Geometry&, const LoadedRecipe&)>;
  void on_load(Adopt adopt) { adopt_ = std::move(adopt); }

  // Reads everything. What is wrong is logged and becomes code(); the error is returned for `--check`.
  Result<void> load();

  // The service thread's share. Once wants_to_load() has said so no capture can start any more; when the one that may
  // still run has ended (`workers_idle`, asked afterwards), serve() does the loading that was asked for.
  [[nodiscard]] bool wants_to_load() const { return busy_ && !changed_; }
  void serve(bool workers_idle);
  // The service thread's too: a calibration that names another camera than the one that answers is refused.
  void check_camera(const std::string& serial);
  // From any thread: the files may have changed; load them anew.
  void reload();

  // Models. Called by the cycle's thread.
  [[nodiscard]] std::uint16_t active_recipe() const override { return active_; }
  [[nodiscard]] bool knows_recipe(std::uint16_t number) const override;
  [[nodiscard]] ResultCode code() const override { return code_; }
  [[nodiscard]] std::int64_t capture_time_us() const override { return capture_time_us_; }
  [[nodiscard]] bool idle() const override { return !busy_; }
  bool take_changed() override { return changed_.exchange(false); }
  void select_recipe(std::uint16_t number) override;
  [[nodiscard]] OfferFrame offer_frame() const override;
  [[nodiscard]] const Grasp* grasp(int template_index, int grasp_index) const override;

  // What is loaded; unchanged while idle() and no cycle has ended since.
  [[nodiscard]] const Geometry& geometry() const { return geometry_; }
  [[nodiscard]] const LoadedRecipe& recipe() const { return loaded_; }
  [[nodiscard]] std::span<const PartModel> models() const { return store_.models(); }

 private:
  Result<void> read_recipes();
  Result<void> load_active();
  Result<void> settle(const Result<void>& outcome);

  const Settings& settings_;
  Log& log_;
  pipeline::ModelStore store_;
  Adopt adopt_;
  Geometry geometry_;
  mutable std::mutex recipes_mutex_;
  std::vector<Recipe> recipes_;
  std::string checked_serial_;  // of the camera judged last
  bool wrong_camera_ = false;
  LoadedRecipe loaded_;
  std::atomic<std::uint16_t> active_{0};
  std::atomic<ResultCode> code_{ResultCode::kNoCalibration};
  std::atomic<std::int64_t> capture_time_us_{0};
  std::atomic<bool> busy_{false};
  std::atomic<bool> changed_{false};
  std::atomic<bool> reload_{false};
};

}  // namespace beltpick::app
