#include "app/kept_models.hpp"

#include <utility>

#include "app/model_import.hpp"

namespace beltpick::app {

KeptModels::KeptModels(service::Store store, RecipeMemory memory)
    : store_(std::move(store)), memory_(std::move(memory)), stored_(store_), imported_(stored_) {}

Result<std::unique_ptr<KeptModels>> KeptModels::open(const Settings& settings, std::vector<std::string>& warnings) {
  const std::filesystem::path folder = from_settings(settings, settings.state);
  auto store = service::Store::open(folder, warnings);
  if (!store) return std::unexpected(store.error());
  for (const auto& [id, bytes] : items_to_import(settings, *store, warnings)) {
    if (const auto put = store->put(id, bytes, "start", "import"); !put) return std::unexpected(put.error());
  }
  RecipeMemory memory(folder, warnings);
  return std::unique_ptr<KeptModels>(new KeptModels(std::move(*store), std::move(memory)));
}

Result<std::unique_ptr<KeptModels>> KeptModels::look(const Settings& settings, std::vector<std::string>& warnings) {
  const std::filesystem::path folder = from_settings(settings, settings.state);
  auto store = service::Store::look(folder, warnings);
  if (!store) return std::unexpected(store.error());
  const auto imports = items_to_import(settings, *store, warnings);
  auto kept = std::unique_ptr<KeptModels>(new KeptModels(std::move(*store), RecipeMemory(folder, warnings)));
  for (const auto& [id, bytes] : imports) kept->imported_.lay(id, bytes);
  return kept;
}

}  // namespace beltpick::app
