// KeptModels: the state folder of an appliance as the source of its models: the store, filled from the configuration's
// files where it never had them, and the recipe that was selected last.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/model_source.hpp"
#include "app/recipe_memory.hpp"
#include "app/settings.hpp"
#include "base/result.hpp"
#include "service/store.hpp"

namespace beltpick::app {

class KeptModels {
 public:
  // Opens or makes the folder. Errors: those of Store::open and Store::put.
  static Result<std::unique_ptr<KeptModels>> open(const Settings& settings, std::vector<std::string>& warnings);
  // The same as open() would find it, with nothing written; a folder that is not there is an empty one.
  static Result<std::unique_ptr<KeptModels>> look(const Settings& settings, std::vector<std::string>& warnings);

  KeptModels(const KeptModels&) = delete;
  KeptModels& operator=(const KeptModels&) = delete;

  // Only after open().
  [[nodiscard]] service::Store& store() { return *store_; }
  [[nodiscard]] const ModelSource& source() const { return imported_; }
  [[nodiscard]] const RecipeMemory& memory() const { return memory_; }

 private:
  KeptModels(std::optional<service::Store> store, RecipeMemory memory);

  std::optional<service::Store> store_;
  RecipeMemory memory_;
  StoreSource stored_;
  OverlaidSource imported_;  // what look() may not write
};

}  // namespace beltpick::app
