// RecipeMemory: which recipe was selected last, kept over a restart: an appliance must not come back with another one
// than the belt's parts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace beltpick::app {

class RecipeMemory {
 public:
  // Remembers nothing.
  RecipeMemory() = default;
  // Remembers in <folder>/active_recipe. A file that tells no number warns and counts as none.
  RecipeMemory(const std::filesystem::path& folder, std::vector<std::string>& warnings);

  // 0 where none was selected yet.
  [[nodiscard]] std::uint16_t number() const { return number_; }
  // Error: kFileNotWritten.
  Result<void> remember(std::uint16_t number);

 private:
  std::filesystem::path file_;
  std::uint16_t number_ = 0;
};

}  // namespace beltpick::app
