// recipe.json, and the sequence it names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

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

// The frames that the recipe projects with `projector`, each with its exposure. Errors: those of read_sequence and
// make_sequence; kCalibrationMismatch where a sequence file is of another projector.
Result<Sequence> recipe_sequence(const Recipe& recipe, const ProjectorGrid& projector, Warnings& warnings);

}  // namespace beltpick::contract_io
