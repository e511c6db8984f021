#include "app/model_judge.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::app {

using service::ItemId;

Result<void> ModelJudge::judge(const ItemId& id, std::string_view bytes, std::vector<std::string>& warnings) const {
  const ModelDocument document{std::string(bytes), item_text(id), id.name};
  switch (id.kind) {
    case ItemKind::kCalibration:
      return judge_calibration(document, warnings);
    case ItemKind::kCell:
      return judge_cell(document, warnings);
    case ItemKind::kTemplate: {
      const auto part = load_template(document, settings_);
      return part ? Result<void>{} : std::unexpected(part.error());
    }
    case ItemKind::kRecipe:
      return judge_recipe(id, bytes, warnings);
  }
  return {};
}

Result<void> ModelJudge::judge_calibration(const ModelDocument& document, Warnings& warnings) const {
  const auto calibration = load_calibration(document, settings_, warnings);
  if (!calibration) return std::unexpected(calibration.error());
  if (auto same = check_serial(*calibration, cell_.camera_serial); !same) return same;
  const auto before = this->calibration();
  const bool told = before && !before->projector_serial.empty() && !calibration->projector_serial.empty();
  if (told && before->projector_serial != calibration->projector_serial) {
    warnings.push_back(contract_io::one_line("calibration: projector_serial: it was '" + before->projector_serial +
                                             "', now it is '" + calibration->projector_serial +
                                             "': is that the projector of this cell?"));
  }
  warn_of_cell(*calibration, warnings);
  return judge_recipes_with(*calibration, warnings);
}

// A new calibration comes first, the cell file that is measured with it after.
void ModelJudge::warn_of_cell(const Calibration& calibration, Warnings& warnings) const {
  const auto document = source_.get(item_id(ItemKind::kCell));
  if (!document) return;
  Warnings ignored;
  const auto cell = load_cell(*document, calibration, ignored);
  if (cell) return;
  warnings.push_back(std::string(cell.error().text()) +
                     ": until a cell file of this calibration is uploaded no cycle can be started");
}

Result<void> ModelJudge::judge_recipes_with(const Calibration& calibration, Warnings& warnings) const {
  for (const ListedRecipe& recipe : recipes()) {
    Warnings ignored;
    const auto planned = plan_recipe(recipe, settings_, calibration, ignored);
    if (planned) continue;
    const bool active = recipe.recipe.number == cell_.active_recipe;
    if (active && planned.error().code == ResultCode::kCalibrationMismatch) {
      return failure(ResultCode::kCalibrationMismatch,
                     "calibration: %s; calibrate the projector that the active recipe '%s' is made for, or first "
                     "upload that with a named sequence",
                     planned.error().detail, recipe.item.id.name.c_str());
    }
    warnings.push_back("recipe '" + recipe.item.id.name +
                       "' cannot be run with this calibration: " + planned.error().detail);
  }
  return {};
}

Result<void> ModelJudge::judge_cell(const ModelDocument& document, Warnings& warnings) const {
  const auto known = calibration();
  if (!known) warnings.push_back("cell: there is no calibration yet that it could be compared with");
  const auto cell = load_cell(document, known.value_or(Calibration{}), warnings);
  return cell ? Result<void>{} : std::unexpected(cell.error());
}

Result<void> ModelJudge::judge_recipe(const ItemId& id, std::string_view bytes, Warnings& warnings) const {
  OverlaidSource with(source_);
  with.lay(id, bytes);
  const auto document = with.get(id);
  if (!document) return std::unexpected(document.error());
  auto recipe = with.parse(*document, warnings);
  if (!recipe) return std::unexpected(recipe.error());
  const ListedRecipe listed{std::move(*recipe), {id, 0}};
  if (auto good = judge_number(listed); !good) return good;
  const auto known = calibration();
  if (known) {
    const auto loaded = load_recipe(listed, with, settings_, *known, warnings);
    return loaded ? Result<void>{} : std::unexpected(loaded.error());
  }
  warnings.push_back("recipe '" + id.name + "': there is no calibration yet that its sequence could be judged with");
  for (const std::string& name : listed.recipe.templates) {
    const auto part = with.get(item_id(ItemKind::kTemplate, name));
    if (!part) return std::unexpected(part.error());
  }
  return {};
}

// The PLC selects by number: it stays with one recipe, and the active one keeps it.
Result<void> ModelJudge::judge_number(const ListedRecipe& recipe) const {
  const unsigned number = recipe.recipe.number;
  const std::string& name = recipe.item.id.name;
  for (const ListedRecipe& other : recipes()) {
    const bool same_item = other.item.id == recipe.item.id;
    if (!same_item && other.recipe.number == number) {
      return failure(
          ResultCode::kValueOutOfRange,
          "recipe '%s': number: expected one that no other recipe has, found %u, that of recipe '%s'; choose "
          "another",
          name.c_str(), number, other.item.id.name.c_str());
    }
    if (same_item && other.recipe.number == cell_.active_recipe && number != cell_.active_recipe) {
      return failure(ResultCode::kItemInUse,
                     "recipe '%s': number: expected %u, under which it is active, found %u; select another recipe "
                     "first, or upload it under another name",
                     name.c_str(), cell_.active_recipe, number);
    }
  }
  return {};
}

Result<void> ModelJudge::judge_removal(const ItemId& id) const {
  if (item_kind(id.kind).single) {
    return failure(ResultCode::kItemInUse, "%s: no cell works without one; upload another instead",
                   item_text(id).c_str());
  }
  for (const ListedRecipe& recipe : recipes()) {
    const auto& templates = recipe.recipe.templates;
    if (id.kind == ItemKind::kTemplate && std::find(templates.begin(), templates.end(), id.name) != templates.end()) {
      return failure(ResultCode::kItemInUse, "%s: recipe '%s' looks for it; remove or change that first",
                     item_text(id).c_str(), recipe.item.id.name.c_str());
    }
    if (recipe.item.id == id && recipe.recipe.number == cell_.active_recipe) {
      return failure(ResultCode::kItemInUse, "%s: it is active; select another recipe first", item_text(id).c_str());
    }
  }
  return {};
}

std::optional<Calibration> ModelJudge::calibration() const {
  const auto document = source_.get(item_id(ItemKind::kCalibration));
  if (!document) return std::nullopt;
  Warnings ignored;
  auto calibration = load_calibration(*document, settings_, ignored);
  return calibration ? std::optional(std::move(*calibration)) : std::nullopt;
}

std::vector<ListedRecipe> ModelJudge::recipes() const {
  std::vector<ListedRecipe> listed;
  Warnings ignored;
  for (const std::string& name : source_.recipes()) {
    const ItemId id = item_id(ItemKind::kRecipe, name);
    const auto document = source_.get(id);
    if (!document) continue;
    auto recipe = source_.parse(*document, ignored);
    if (recipe) listed.push_back({std::move(*recipe), {id, document->version}});
  }
  return listed;
}

}  // namespace beltpick::app
