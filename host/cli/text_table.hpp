// A table for people: columns as wide as their widest cell.
#pragma once

#include <string>
#include <vector>

namespace beltpick::cli {

// A line a row, two spaces between columns, `indent` before each; the first row may be a heading like the others.
std::string text_table(const std::vector<std::vector<std::string>>& rows, std::size_t indent = 0);

}  // namespace beltpick::cli
