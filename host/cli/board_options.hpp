// The options that tell the printed plate, of every command that looks for it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "base/result.hpp"
#include "calibrate/observations.hpp"

namespace beltpick::cli {

struct BoardOptions {
  std::string size;  // "11x8"; empty where not given
  double square_mm = 0.0;
  bool charuco = false;
  double marker_mm = 0.0;  // 0: three quarters of a square
  std::string dictionary = "DICT_4X4_100";
};

void add_board_options(CLI::App& app, BoardOptions& options);

// The board. Errors: kUsage (no --board or no --square-mm, or not of that form), kValueOutOfRange.
Result<calibrate::Board> board_of(const BoardOptions& options);

}  // namespace beltpick::cli
