// The explanation's page: a section a segment, in words, tables and pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "explain/chapter.hpp"
#include "explain/explain.hpp"

namespace beltpick::explain {

// Writes the pictures into `folder` and returns the page's body, which refers to them. Error: kFileNotWritten.
Result<std::string> explanation_body(const std::filesystem::path& folder, const Explained& explained,
                                     const std::vector<Chapter>& chapters);

}  // namespace beltpick::explain
