#include "app/model_source.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/recipe_io.hpp"

namespace beltpick::app {

namespace {

using service::ItemId;

// What it means that `id` is not there.
Result<ModelDocument> missing(const ItemId& id) {
  const std::string what = item_text(id);
  switch (id.kind) {
    case ItemKind::kCell:
      return ModelDocument{};
    case ItemKind::kCalibration:
      return failure(ResultCode::kNoCalibration, "calibration: expected one, found none; calibrate and upload it");
    case ItemKind::kTemplate:
      return failure(ResultCode::kNoTemplate, "%s is not there; teach and upload it", what.c_str());
    case ItemKind::kRecipe:
      return failure(ResultCode::kRecipeUnknown, "%s is not there; upload it", what.c_str());
  }
  return ModelDocument{};
}

}  // namespace

std::string item_text(const ItemId& id) {
  const ItemKindEntry& kind = item_kind(id.kind);
  std::string text(kind.name);
  if (!kind.single) text += " '" + id.name + "'";
  return text;
}

ItemId item_id(ItemKind kind, const std::string& name) {
  const ItemKindEntry& entry = item_kind(kind);
  return {kind, entry.single ? std::string(entry.name) : name};
}

Result<ModelDocument> FileSource::get(const ItemId& id) const {
  std::string path = id.name;
  if (id.kind == ItemKind::kCalibration) path = settings_.calibration;
  if (id.kind == ItemKind::kCell) path = settings_.cell;
  if (path.empty() && id.kind == ItemKind::kCalibration) {
    return failure(ResultCode::kNoCalibration, "model.calibration: expected a file, found none; calibrate and name it");
  }
  if (path.empty()) return missing(id);
  const std::filesystem::path file = from_settings(settings_, path);
  auto bytes = contract_io::read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  return ModelDocument{std::move(*bytes), file.string(), file.stem().string()};
}

Result<Recipe> FileSource::parse(const ModelDocument& recipe, std::vector<std::string>& warnings) const {
  const std::filesystem::path folder = std::filesystem::absolute(recipe.source).parent_path();
  return contract_io::parse_recipe(recipe.bytes, recipe.source, folder, warnings);
}

Result<ModelDocument> StoreSource::get(const ItemId& id) const {
  for (const service::Store::Fallback& fallback : store_.fallbacks()) {
    if (fallback.id != id) continue;
    return failure(ResultCode::kChecksumWrong,
                   "%s: expected version %u whole, found it damaged on the disk; upload it again, or roll back to an "
                   "older version",
                   item_text(id).c_str(), fallback.damaged);
  }
  if (!store_.current(id)) return missing(id);
  auto version = store_.get(id);
  if (!version) return std::unexpected(version.error());
  const std::uint32_t number = version->info.version;
  return ModelDocument{std::move(version->bytes), item_text(id) + " version " + std::to_string(number), id.name,
                       number};
}

std::vector<std::string> StoreSource::recipes() const {
  std::vector<std::string> names;
  for (const ItemId& id : store_.list()) {
    if (id.kind == ItemKind::kRecipe) names.push_back(id.name);
  }
  return names;
}

Result<Recipe> StoreSource::parse(const ModelDocument& recipe, std::vector<std::string>& warnings) const {
  return contract_io::parse_stored_recipe(recipe.bytes, recipe.source, recipe.name, warnings);
}

Result<ModelDocument> OverlaidSource::get(const ItemId& id) const {
  const auto at = items_.find(id);
  if (at == items_.end()) return below_.get(id);
  return ModelDocument{at->second, item_text(id), id.name};
}

std::vector<std::string> OverlaidSource::recipes() const {
  std::vector<std::string> names = below_.recipes();
  for (const auto& [id, bytes] : items_) {
    const bool is_new = id.kind == ItemKind::kRecipe && std::find(names.begin(), names.end(), id.name) == names.end();
    if (is_new) names.push_back(id.name);
  }
  return names;
}

}  // namespace beltpick::app
