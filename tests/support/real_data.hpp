// Where the real captures are, for tests that use them: BELTPICK_REAL_DATA, or the data folder beside the sources.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace beltpick::test {

// The folder of that name among the real data; empty, with a word about it, where it is missing.
inline std::filesystem::path real_data(const char* name) {
  const char* given = std::getenv("BELTPICK_REAL_DATA");
  const std::filesystem::path root =
      given != nullptr ? std::filesystem::path(given) : std::filesystem::path(BELTPICK_SOURCE_DIR) / "../shared/data";
  if (std::filesystem::is_directory(root / name)) return root / name;
  WARN("skipped: no real data at " << (root / name) << "; set BELTPICK_REAL_DATA");
  return {};
}

}  // namespace beltpick::test
