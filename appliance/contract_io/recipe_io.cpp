#include "contract_io/recipe_io.hpp"

#include <algorithm>

#include "contract/api.hpp"
#include "contract/exposures.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/sequence_json.hpp"

namespace beltpick::contract_io {
namespace {

constexpr const char* kFormat = "beltpick-recipe";
constexpr int kVersion = 1;
constexpr double kMaxTime_us = 1e6;  // what the trigger microcontroller takes
constexpr std::size_t kMaxTemplates = 64;

std::string from_folder(const std::filesystem::path& folder, const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(folder / path).lexically_normal().string();
}

std::vector<std::string> read_templates(JsonObject& root) {
  std::vector<std::string> templates = root.texts("templates");
  if (templates.empty()) root.fail(ResultCode::kMemberMissing, "templates", "at least one template", "none");
  if (templates.size() > kMaxTemplates) {
    root.fail(ResultCode::kValueOutOfRange, "templates", "at most " + std::to_string(kMaxTemplates) + " templates",
              std::to_string(templates.size()));
  }
  return templates;
}

// "sequence" as an object: the content of a sequence.json, with or without its format and version.
Sequence read_own_sequence(JsonDocument& document, JsonObject object) {
  (void)object.choice("format", {"beltpick-sequence", "beltpick-capture"}, 0);
  (void)object.integer("version", {1, 1}, 1);
  object.ignore("id");
  object.ignore("full_scale");
  Sequence sequence = read_sequence_members(document, object);
  object.finish();
  return sequence;
}

std::string item_name(const std::string& of) {
  const std::string_view extension = item_kind(ItemKind::kTemplate).extension;
  return of.ends_with(extension) ? of.substr(0, of.size() - extension.size()) : of;
}

// The recipe as it stands in the text: names and paths are not looked at yet.
Result<Recipe> parse_members(std::string_view text, const std::string& source, const std::string& name,
                             Warnings& warnings) {
  JsonDocument document(text, source, warnings);
  JsonObject root = document.root({kFormat}, kVersion);
  Recipe recipe;
  recipe.number = static_cast<std::uint16_t>(root.integer("number", {1, 65535}));
  recipe.name = root.text("name", name);
  if (root.is_object("sequence")) {
    recipe.own_sequence = read_own_sequence(document, root.object("sequence"));
  } else {
    recipe.sequence = root.text("sequence", recipe.sequence);
  }
  recipe.axes = static_cast<SequenceAxes>(
      root.choice("axes", {kSequenceAxesNames[0], kSequenceAxesNames[1], kSequenceAxesNames[2]}, 0));
  recipe.exposure_us = root.number("exposure_us", {1, kMaxTime_us});
  recipe.exposures_us = root.number_list("exposures_us", {1, kMaxTime_us}, kMaxExposures);
  recipe.settle_us = root.number("settle_us", {100, kMaxTime_us}, recipe.settle_us);
  recipe.period_us = root.number("period_us", {0, kMaxTime_us}, recipe.period_us);
  recipe.templates = read_templates(root);
  root.finish();
  double longest_us = recipe.exposures_us.empty() ? recipe.exposure_us : 0.0;
  for (const double exposure_us : recipe.exposures_us) longest_us = std::max(longest_us, exposure_us);
  if (!document.failed() && recipe.period_us > 0.0 && recipe.settle_us + longest_us > recipe.period_us) {
    root.fail(ResultCode::kValueOutOfRange, "period_us", "0, or at least settle_us + the longest exposure",
              std::to_string(recipe.period_us));
  }
  if (document.failed()) return document.error();
  return recipe;
}

}  // namespace

Result<Recipe> parse_recipe(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                            Warnings& warnings) {
  auto recipe = parse_members(text, name, std::filesystem::path(name).stem().string(), warnings);
  if (!recipe) return recipe;
  if (!find_sequence_name(recipe->sequence)) recipe->sequence = from_folder(folder, recipe->sequence);
  for (std::string& path : recipe->templates) path = from_folder(folder, path);
  return recipe;
}

Result<Recipe> parse_stored_recipe(std::string_view text, const std::string& source, const std::string& name,
                                   Warnings& warnings) {
  auto recipe = parse_members(text, source, name, warnings);
  if (!recipe) return recipe;
  if (!find_sequence_name(recipe->sequence)) {
    return failure(
        ResultCode::kValueOutOfRange,
        "%s: sequence: expected fast, standard, robust, micro or the content of a sequence.json, found '%s'; "
        "`beltpick upload recipe` puts the file's content in its place",
        source.c_str(), one_line(recipe->sequence).c_str());
  }
  for (std::string& part : recipe->templates) {
    part = item_name(part);
    if (is_item_name(part)) continue;
    return failure(ResultCode::kValueOutOfRange,
                   "%s: templates: expected names of the appliance's templates, found '%s'; `beltpick upload recipe` "
                   "puts names in the place of paths",
                   source.c_str(), one_line(part).c_str());
  }
  return recipe;
}

Result<Recipe> read_recipe(const std::filesystem::path& path, Warnings& warnings) {
  const auto text = read_file(path, std::size_t{1} << 20U);
  if (!text) return std::unexpected(text.error());
  return parse_recipe(*text, path.string(), std::filesystem::absolute(path).parent_path(), warnings);
}

std::string recipe_text(const Recipe& recipe) {
  Json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["number"] = recipe.number;
  json["name"] = recipe.name;
  if (recipe.own_sequence) {
    append_sequence(*recipe.own_sequence, json["sequence"]);
  } else {
    json["sequence"] = recipe.sequence;
  }
  json["axes"] = kSequenceAxesNames[static_cast<std::size_t>(recipe.axes)];
  json["exposure_us"] = recipe.exposure_us;
  if (!recipe.exposures_us.empty()) json["exposures_us"] = recipe.exposures_us;
  json["settle_us"] = recipe.settle_us;
  json["period_us"] = recipe.period_us;
  json["templates"] = recipe.templates;
  return json_text(json);
}

Result<void> write_recipe(const std::filesystem::path& path, const Recipe& recipe) {
  return write_file(path, recipe_text(recipe));
}

Result<PortableRecipe> portable_recipe(const std::filesystem::path& path, Warnings& warnings) {
  auto recipe = read_recipe(path, warnings);
  if (!recipe) return std::unexpected(recipe.error());
  if (!recipe->own_sequence && !find_sequence_name(recipe->sequence)) {
    auto sequence = read_sequence(recipe->sequence, warnings);
    if (!sequence) return std::unexpected(sequence.error());
    recipe->own_sequence = std::move(*sequence);
  }
  PortableRecipe portable;
  for (std::string& part : recipe->templates) {
    const std::filesystem::path from = part;
    part = item_name(from.filename().string());
    const auto same = [&](const PortableRecipe::Template& other) { return other.name == part && other.path != from; };
    const bool twice = std::any_of(portable.templates.begin(), portable.templates.end(), same);
    if (twice || !is_item_name(part)) {
      return failure(ResultCode::kValueOutOfRange,
                     "%s: templates: expected files whose names differ, of letters, digits, '.', '_' and '-', found "
                     "'%s'%s; rename it",
                     one_line(path.string()).c_str(), one_line(from.string()).c_str(), twice ? " and another" : "");
    }
    portable.templates.push_back({part, from});
  }
  portable.text = recipe_text(*recipe);
  return portable;
}

Result<Sequence> recipe_sequence(const Recipe& recipe, const ProjectorGrid& projector, Warnings& warnings) {
  const auto named = find_sequence_name(recipe.sequence);
  auto sequence = recipe.own_sequence ? Result<Sequence>(*recipe.own_sequence)
                  : named             ? make_sequence(*named, projector, recipe.axes)
                                      : read_sequence(recipe.sequence, warnings);
  if (!sequence) return sequence;
  const ProjectorGrid& found = sequence->projector;
  if (found.width != projector.width || found.height != projector.height) {
    return failure(
        ResultCode::kCalibrationMismatch,
        "%s: projector: expected the calibration's %dx%d, found %dx%d; use a sequence made for this projector",
        recipe.own_sequence ? "sequence" : recipe.sequence.c_str(), projector.width, projector.height, found.width,
        found.height);
  }
  if (!recipe.exposures_us.empty()) return at_exposures(*sequence, recipe.exposures_us);
  for (FrameSpec& frame : sequence->frames) {
    if (frame.exposure_us <= 0.0) frame.exposure_us = recipe.exposure_us;
  }
  return sequence;
}

}  // namespace beltpick::contract_io
