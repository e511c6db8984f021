// A JSON file as tests read it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/temp_folder.hpp"

namespace beltpick::test {

inline nlohmann::json json_of(const std::filesystem::path& path) { return nlohmann::json::parse(file_bytes(path)); }

}  // namespace beltpick::test
