#include "upload_item.hpp"

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_writer.hpp"
#include "contract_io/recipe_io.hpp"
#include "contract_io/template_io.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;
using contract_io::Warnings;

// A Result of any type as one that only tells whether it went well.
template <class T>
Result<void> verdict(const Result<T>& result) {
  if (!result) return std::unexpected(result.error());
  return {};
}

// The name that the appliance knows a template by, whatever path led to it here.
std::string template_name(const std::string& path) {
  const std::filesystem::path file(path);
  return file.extension() == item_kind(ItemKind::kTemplate).extension ? file.stem().string() : file.filename().string();
}

// The sequence that a recipe names by its path, as an object of the same members.
Result<Json> sequence_object(const std::filesystem::path& path) {
  Warnings warnings;  // the appliance repeats them
  if (auto judged = verdict(contract_io::read_sequence(path, warnings)); !judged) {
    return std::unexpected(judged.error());
  }
  const auto text = contract_io::read_file(path);
  if (!text) return std::unexpected(text.error());
  return Json::parse(*text, nullptr, false);
}

// The recipe as the appliance takes it: without paths. The file's own bytes where there are none in it.
Result<std::string> recipe_bytes(const std::filesystem::path& file, const std::string& text) {
  Warnings warnings;
  if (auto judged = verdict(contract_io::read_recipe(file, warnings)); !judged) return std::unexpected(judged.error());
  const Json original = Json::parse(text, nullptr, false);
  Json recipe = original;
  if (recipe.contains("sequence") && recipe["sequence"].is_string()) {
    const std::string sequence = recipe["sequence"].get<std::string>();
    if (!find_sequence_name(sequence)) {
      auto object = sequence_object(file.parent_path() / sequence);
      if (!object) return std::unexpected(object.error());
      recipe["sequence"] = std::move(*object);
    }
  }
  for (Json& part : recipe["templates"]) {
    const std::string path = part.get<std::string>();
    if (path != template_name(path)) part = template_name(path);
  }
  return recipe == original ? text : contract_io::json_text(recipe);
}

Result<std::string> judged_bytes(ItemKind kind, const std::filesystem::path& file, std::string text) {
  Warnings warnings;
  switch (kind) {
    case ItemKind::kRecipe:
      return recipe_bytes(file, text);
    case ItemKind::kTemplate:
      if (auto judged = verdict(contract_io::read_template(file)); !judged) return std::unexpected(judged.error());
      break;
    case ItemKind::kCalibration:
      if (auto judged = verdict(contract_io::parse_calibration(text, file.string(), warnings)); !judged) {
        return std::unexpected(judged.error());
      }
      break;
    case ItemKind::kCell:
      if (auto judged = verdict(contract_io::parse_cell(text, file.string(), warnings)); !judged) {
        return std::unexpected(judged.error());
      }
      break;
  }
  return text;
}

Result<std::string> item_name(const ItemKindEntry& kind, const std::filesystem::path& file, const std::string& wish) {
  if (kind.single) return std::string(kind.name);
  const std::string name = wish.empty() ? file.stem().string() : wish;
  if (is_item_name(name)) return name;
  return failure(ResultCode::kUsage,
                 "%s: expected a name of letters, digits, '.', '_' and '-', at most %zu, found '%s'; give one with "
                 "--name",
                 contract_io::one_line(file.string()).c_str(), kMaxItemName, contract_io::one_line(name).c_str());
}

}  // namespace

Result<UploadItem> prepare_upload(ItemKind kind, const std::filesystem::path& file, const std::string& name) {
  const ItemKindEntry& entry = item_kind(kind);
  const auto id = item_name(entry, file, name);
  if (!id) return std::unexpected(id.error());
  auto text = contract_io::read_file(file, entry.max_bytes);
  if (!text) return std::unexpected(text.error());
  auto bytes = judged_bytes(kind, file, std::move(*text));
  if (!bytes) return std::unexpected(bytes.error());
  if (bytes->size() <= entry.max_bytes) {
    return UploadItem{file.string(), {std::string(entry.name), *id, {}}, std::move(*bytes)};
  }
  return failure(ResultCode::kLimitExceeded, "%s: expected at most %zu bytes with its sequence, found %zu",
                 file.c_str(), entry.max_bytes, bytes->size());
}

}  // namespace beltpick::cli
