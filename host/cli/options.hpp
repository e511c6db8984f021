// Options that several commands share.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace beltpick::cli {

// The example at the foot of a command's --help.
void example(CLI::App& app, const std::string& lines);

// The choices of an option, from the names that the contract gives an enumeration.
template <class Names>
std::vector<std::string> choices(const Names& names) {
  return {names.begin(), names.end()};
}

// The enumerator called `name`, which is among `names`.
template <class Enum, class Names>
Enum enum_of(const std::string& name, const Names& names) {
  return static_cast<Enum>(std::find(names.begin(), names.end(), name) - names.begin());
}

struct SizePx {
  int width = 0;
  int height = 0;
};

// "912x1140": two positive numbers. Error: kUsage, naming `option`.
Result<SizePx> parse_size(const std::string& text, const char* option);

}  // namespace beltpick::cli
