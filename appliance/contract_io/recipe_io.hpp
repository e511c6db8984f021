// recipe.json, the sequence it names, and the form in which an appliance keeps both.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "contract/recipe.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::contract_io {

// Reads and judges a recipe; paths in it are made absolute from `folder`, or the file's. `name` stands in messages, and
// its stem names a recipe without a name. Errors: kFormatInvalid, kMemberMissing, kValueOutOfRange,
// kVersionUnsupported; from a file also kFileNotFound, kFileUnreadable.
Result<Recipe> parse_recipe(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                            Warnings& warnings);
Result<Recipe> read_recipe(const std::filesystem::path& path, Warnings& warnings);
Result<void> write_recipe(const std::filesystem::path& path, const Recipe& recipe);
std::string recipe_text(const Recipe& recipe);

// A recipe of the appliance's store, which stands by itself: `templates` become plain item names. `source` stands in
// messages, `name` is that of a recipe that tells none. Errors: as above; kValueOutOfRange where it names a path.
Result<Recipe> parse_stored_recipe(std::string_view text, const std::string& source, const std::string& name,
                                   Warnings& warnings);

// What an appliance keeps of the recipe file `path`: text that stands by itself, and the templates that it needs.
struct PortableRecipe {
  std::string text;
  struct Template {
    std::string name;            // as the recipe names it
    std::filesystem::path path;  // where it was found
  };
  std::vector<Template> templates;
};
// Errors: those of read_recipe and read_sequence; kValueOutOfRange where the name of a template's file cannot be that
// of an item, or stands for two files.
Result<PortableRecipe> portable_recipe(const std::filesystem::path& path, Warnings& warnings);

// The frames that the recipe projects with `projector`, each with its exposure. Errors: those of read_sequence and
// make_sequence; kCalibrationMismatch where a sequence file is of another projector.
Result<Sequence> recipe_sequence(const Recipe& recipe, const ProjectorGrid& projector, Warnings& warnings);

}  // namespace beltpick::contract_io
