// KeptModels: the state folder of an appliance as the source of its models: the store, filled from the configuration's
// files where it never had them, and the recipe that was selected last.
#pragma once

#include <memory>
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
  // What open() would find, with nothing written.
  static Result<std::unique_ptr<KeptModels>> look(const Settings& settings, std::vector<std::string>& warnings);

  KeptModels(const KeptModels&) = delete;
  KeptModels& operator=(const KeptModels&) = delete;

  // put() and remove() only after open().
  [[nodiscard]] service::Store& store() { return store_; }
  [[nodiscard]] const ModelSource& source() const { return imported_; }
  [[nodiscard]] const RecipeMemory& memory() const { return memory_; }

 private:
  KeptModels(service::Store store, RecipeMemory memory);

  service::Store store_;
  RecipeMemory memory_;
  StoreSource stored_;
  OverlaidSource imported_;  // what look() may not write
};

}  // namespace beltpick::app
