#include "contract_io/recipe_io.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::contract_io {
namespace {

constexpr const char* kFormat = "beltpick-recipe";
constexpr int kVersion = 1;
constexpr double kMaxTime_us = 1e6;  // what the trigger microcontroller takes

std::string from_folder(const std::filesystem::path& folder, const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(folder / path).lexically_normal().string();
}

std::vector<std::string> read_templates(JsonObject& root) {
  std::vector<std::string> templates = root.texts("templates");
  if (templates.empty()) root.fail(ResultCode::kMemberMissing, "templates", "at least one template", "none");
  return templates;
}

}  // namespace

Result<Recipe> parse_recipe(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                            Warnings& warnings) {
  JsonDocument document(text, name, warnings);
  JsonObject root = document.root({kFormat}, kVersion);
  Recipe recipe;
  recipe.number = static_cast<std::uint16_t>(root.integer("number", {1, 65535}));
  recipe.name = root.text("name", std::filesystem::path(name).stem().string());
  recipe.sequence = root.text("sequence", recipe.sequence);
  recipe.axes = static_cast<SequenceAxes>(
      root.choice("axes", {kSequenceAxesNames[0], kSequenceAxesNames[1], kSequenceAxesNames[2]}, 0));
  recipe.exposure_us = root.number("exposure_us", {1, kMaxTime_us});
  recipe.settle_us = root.number("settle_us", {100, kMaxTime_us}, recipe.settle_us);
  recipe.period_us = root.number("period_us", {0, kMaxTime_us}, recipe.period_us);
  recipe.templates = read_templates(root);
  root.finish();
  if (!document.failed() && recipe.period_us > 0.0 && recipe.settle_us + recipe.exposure_us > recipe.period_us) {
    root.fail(ResultCode::kValueOutOfRange, "period_us", "0, or at least settle_us + exposure_us",
              std::to_string(recipe.period_us));
  }
  if (document.failed()) return document.error();
  if (!find_sequence_name(recipe.sequence)) recipe.sequence = from_folder(folder, recipe.sequence);
  for (std::string& path : recipe.templates) path = from_folder(folder, path);
  return recipe;
}

Result<Recipe> read_recipe(const std::filesystem::path& path, Warnings& warnings) {
  const auto text = read_file(path, std::size_t{1} << 20U);
  if (!text) return std::unexpected(text.error());
  return parse_recipe(*text, path.string(), std::filesystem::absolute(path).parent_path(), warnings);
}

Result<void> write_recipe(const std::filesystem::path& path, const Recipe& recipe) {
  Json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["number"] = recipe.number;
  json["name"] = recipe.name;
  json["sequence"] = recipe.sequence;
  json["axes"] = kSequenceAxesNames[static_cast<std::size_t>(recipe.axes)];
  json["exposure_us"] = recipe.exposure_us;
  json["settle_us"] = recipe.settle_us;
  json["period_us"] = recipe.period_us;
  json["templates"] = recipe.templates;
  return write_file(path, json_text(json));
}

Result<Sequence> recipe_sequence(const Recipe& recipe, const ProjectorGrid& projector, Warnings& warnings) {
  const auto named = find_sequence_name(recipe.sequence);
  auto sequence = named ? make_sequence(*named, projector, recipe.axes) : read_sequence(recipe.sequence, warnings);
  if (!sequence) return sequence;
  const ProjectorGrid& found = sequence->projector;
  if (found.width != projector.width || found.height != projector.height) {
    return failure(
        ResultCode::kCalibrationMismatch,
        "%s: projector: expected the calibration's %dx%d, found %dx%d; use a sequence made for this projector",
        recipe.sequence.c_str(), projector.width, projector.height, found.width, found.height);
  }
  for (FrameSpec& frame : sequence->frames) {
    if (frame.exposure_us <= 0.0) frame.exposure_us = recipe.exposure_us;
  }
  return sequence;
}

}  // namespace beltpick::contract_io
