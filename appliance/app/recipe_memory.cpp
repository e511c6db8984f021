#include "app/recipe_memory.hpp"

#include <charconv>

#include "contract_io/file_io.hpp"

namespace beltpick::app {

RecipeMemory::RecipeMemory(const std::filesystem::path& folder, std::vector<std::string>& warnings)
    : file_(folder / "active_recipe") {
  std::error_code error;
  if (!std::filesystem::exists(file_, error)) return;
  const auto text = contract_io::read_file(file_, 64);
  std::uint16_t number = 0;
  if (text) std::from_chars(text->data(), text->data() + text->size(), number);
  if (number == 0) {
    warnings.push_back(file_.string() + ": expected the number of a recipe, found something else; select a recipe");
  }
  number_ = number;
}

Result<void> RecipeMemory::remember(std::uint16_t number) {
  if (file_.empty() || number == number_) return {};
  if (auto written = contract_io::write_file(file_, std::to_string(number) + "\n"); !written) return written;
  number_ = number;
  return {};
}

}  // namespace beltpick::app
