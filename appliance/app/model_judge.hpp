// ModelJudge: whether the cell could work with an upload and with all else as it stands: a dry run of the loading that
// would follow.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "app/loaded_recipe.hpp"
#include "app/model_source.hpp"
#include "app/settings.hpp"
#include "base/result.hpp"

namespace beltpick::app {

// What the judge must know of the running cell.
struct JudgedCell {
  std::uint16_t active_recipe = 0;  // 0: none yet
  std::string camera_serial;        // of the camera that answers; empty where none did
};

class ModelJudge {
 public:
  ModelJudge(const ModelSource& source, const Settings& settings, JudgedCell cell)
      : source_(source), settings_(settings), cell_(std::move(cell)) {}

  // As CellSide::judge(). A calibration of another projector than the active recipe's sequence is made for is refused;
  // one that needs a new cell file, or new sequences of other recipes, is taken with a warning that says so.
  Result<void> judge(const service::ItemId& id, std::string_view bytes, std::vector<std::string>& warnings) const;
  // As CellSide::judge_removal().
  Result<void> judge_removal(const service::ItemId& id) const;

 private:
  using Warnings = std::vector<std::string>;
  Result<void> judge_calibration(const ModelDocument& document, Warnings& warnings) const;
  void warn_of_cell(const Calibration& calibration, Warnings& warnings) const;
  Result<void> judge_recipes_with(const Calibration& calibration, Warnings& warnings) const;
  Result<void> judge_cell(const ModelDocument& document, Warnings& warnings) const;
  Result<void> judge_recipe(const service::ItemId& id, std::string_view bytes, Warnings& warnings) const;
  Result<void> judge_number(const ListedRecipe& recipe) const;
  // The calibration in the store; nothing where there is none that could be used.
  [[nodiscard]] std::optional<Calibration> calibration() const;
  // The recipes in the store; none where they cannot be read.
  [[nodiscard]] std::vector<ListedRecipe> recipes() const;

  const ModelSource& source_;
  const Settings& settings_;
  JudgedCell cell_;
};

}  // namespace beltpick::app
