// ModelHub: calibration, cell, recipe and templates in use, and the next ones. They stand in two halves of the memory:
// the cell works on one while the models' own thread reads, judges and builds what is to come in the other; between a
// cycle's captures the halves change places. Loads at start, when the PLC selects another recipe, and when told that
// something was uploaded.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/loaded_recipe.hpp"
#include "app/log.hpp"
#include "app/models.hpp"
#include "app/recipe_memory.hpp"
#include "app/recipe_numbers.hpp"
#include "pipeline/model_store.hpp"

namespace beltpick::app {

class ModelHub : public Models {
 public:
  // Takes the memory of the template models, twice, from the arena. Models come from the configuration's files.
  ModelHub(Arena& arena, const Settings& settings, Log& log);

  // Another source, and what was selected before the restart. Before load().
  void use(const ModelSource& source, RecipeMemory memory);

  // What makes the pipeline ready for other models, called while neither capture nor pipeline runs; takes the fold plan
  // with it. An error makes the recipe unusable.
  using Adopt = std::function<Result<void>(const Geometry&, LoadedRecipe&)>;
  void on_load(Adopt adopt) { adopt_ = std::move(adopt); }

  // Reads everything, at start. What is wrong is logged and becomes code(); the error is returned for `--check`.
  Result<void> load();

  // The share of the models' thread, to be called again and again: prepares what was asked for; once that is ready,
  // holds captures off, tells the cycle, and when `workers_idle` changes the halves.
  void serve(const std::function<bool()>& workers_idle);
  // The same thread's: a calibration that names another camera than the one that answers is refused.
  void check_camera(const std::string& serial);
  // From any thread: something may have changed; what is in use is loaded anew where it did.
  void reload() { reload_ = true; }

  // Models. Called by the cycle's thread.
  [[nodiscard]] std::uint16_t active_recipe() const override { return active_; }
  [[nodiscard]] bool knows_recipe(std::uint16_t number) const override { return numbers_.has(number); }
  [[nodiscard]] ResultCode code() const override;
  [[nodiscard]] std::int64_t capture_time_us() const override { return capture_time_us_; }
  [[nodiscard]] bool idle() const override { return !holding_ && asked_ == served_; }
  bool take_changed() override { return changed_.exchange(false); }
  void select_recipe(std::uint16_t number) override;
  [[nodiscard]] OfferFrame offer_frame() const override;
  [[nodiscard]] const Grasp* grasp(int template_index, int grasp_index) const override;

  // What is in use; unchanged while idle() and no cycle has ended since.
  [[nodiscard]] const Geometry& geometry() const { return active().geometry; }
  [[nodiscard]] const LoadedRecipe& recipe() const { return active().recipe; }
  [[nodiscard]] std::span<const PartModel> models() const { return stores_[half_].models(); }

  // The same for a person, from any thread but those that may not wait.
  struct InUse {
    Error problem;              // why no cycle can be started; kOk where one can
    Error calibration_problem;  // kOk: the one read last is good, and this
    std::string calibration_id, calibration_camera;
    std::uint16_t recipe = 0;  // what follows is what was in use last; 0: nothing yet
    std::string recipe_name;
    int frames = 0, templates = 0;
    std::vector<service::ItemInUse> items;
    std::string camera_serial;  // of the camera that answered last
  };
  [[nodiscard]] InUse in_use() const;

 private:
  struct Half {
    Geometry geometry;
    LoadedRecipe recipe;
  };
  [[nodiscard]] const Half& active() const { return halves_[half_]; }
  [[nodiscard]] std::size_t standby() const { return 1 - half_; }

  void prepare();
  Result<Half> read(std::vector<std::string>& warnings);
  Result<std::uint16_t> choose(const std::vector<ListedRecipe>& listed) const;
  [[nodiscard]] bool in_use_already(const Half& half) const;
  void keep();
  void change();
  void settle();
  void tell_calibration(const Result<Geometry>& geometry);
  void tell_in_use(const Result<void>& outcome);
  void tell(const std::vector<std::string>& warnings);

  const Settings& settings_;
  Log& log_;
  FileSource files_;
  const ModelSource* source_;
  RecipeMemory memory_;
  Adopt adopt_;
  std::array<pipeline::ModelStore, 2> stores_;
  std::array<Half, 2> halves_;
  RecipeNumbers numbers_;

  // The models' thread's alone.
  std::uint32_t prepared_for_ = 0;         // the last wish of the cycle's thread that was looked at
  bool announce_ = false;                  // not the cycle's thread asked: it must be told before the halves change
  std::optional<Result<void>> candidate_;  // in the standby half: ready, or why the recipe cannot be run
  bool standby_is_new_ = false;            // else the active half stays
  bool whole_ = false;                     // the active half holds something

  std::atomic<std::size_t> half_{0};
  std::atomic<std::uint16_t> active_{0};
  std::atomic<ResultCode> load_code_{ResultCode::kNoCalibration};
  std::atomic<bool> wrong_camera_{false};
  std::atomic<std::int64_t> capture_time_us_{0};
  std::atomic<std::uint32_t> asked_{0}, served_{0};  // wishes of the cycle's thread
  std::atomic<bool> holding_{false};                 // no capture may start
  std::atomic<bool> changed_{false};
  std::atomic<bool> reload_{false};

  mutable std::mutex in_use_mutex_;
  InUse in_use_;
};

}  // namespace beltpick::app
