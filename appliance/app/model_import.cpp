#include "app/model_import.hpp"

#include <algorithm>

#include "app/model_source.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/recipe_io.hpp"

namespace beltpick::app {

namespace {

namespace fs = std::filesystem;
using service::ItemId;

class Import {
 public:
  Import(const service::Store& store, std::vector<std::string>& warnings) : store_(store), warnings_(warnings) {}

  void file(const ItemId& id, const fs::path& path) {
    std::error_code error;
    if (!wanted(id) || path.empty() || !fs::exists(path, error)) return;
    auto bytes = contract_io::read_file(path);
    if (!bytes) return leave_out(bytes.error());
    items_.emplace_back(id, std::move(*bytes));
  }

  void recipe(const fs::path& path) {
    const ItemId id = item_id(ItemKind::kRecipe, path.stem().string());
    std::error_code error;
    if (!wanted(id) || !fs::exists(path, error)) return;
    if (!is_item_name(id.name)) {
      warnings_.push_back("not imported: " + contract_io::one_line(path.string()) +
                          ": expected a name of letters, digits, '.', '_' and '-'; rename it");
      return;
    }
    auto portable = contract_io::portable_recipe(path, warnings_);
    if (!portable) return leave_out(portable.error());
    for (const auto& part : portable->templates) file(item_id(ItemKind::kTemplate, part.name), part.path);
    items_.emplace_back(id, std::move(portable->text));
  }

  [[nodiscard]] ImportedItems take() { return std::move(items_); }

 private:
  // What was removed stays so.
  [[nodiscard]] bool wanted(const ItemId& id) const {
    const auto same = [&](const auto& item) { return item.first == id; };
    return std::none_of(items_.begin(), items_.end(), same) && store_.versions(id).empty();
  }
  void leave_out(const Error& error) { warnings_.push_back(std::string("not imported: ") + error.detail); }

  const service::Store& store_;
  std::vector<std::string>& warnings_;
  ImportedItems items_;
};

}  // namespace

ImportedItems items_to_import(const Settings& settings, const service::Store& store,
                              std::vector<std::string>& warnings) {
  Import import(store, warnings);
  import.file(item_id(ItemKind::kCalibration), from_settings(settings, settings.calibration));
  import.file(item_id(ItemKind::kCell), from_settings(settings, settings.cell));
  for (const std::string& recipe : settings.recipes) import.recipe(from_settings(settings, recipe));
  return import.take();
}

}  // namespace beltpick::app
