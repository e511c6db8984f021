// Options that several commands share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "base/result.hpp"

namespace beltpick::cli {

// The example at the foot of a command's --help.
void example(CLI::App& app, const std::string& lines);

struct SizePx {
  int width = 0;
  int height = 0;
};

// "912x1140": two positive numbers. Error: kUsage, naming `option`.
Result<SizePx> parse_size(const std::string& text, const char* option);

}  // namespace beltpick::cli
