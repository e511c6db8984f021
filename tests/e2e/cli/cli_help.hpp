// The commands as the program's own help lists them.
#pragma once

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace beltpick::test {

inline std::vector<std::string> listed_commands() {
  std::vector<std::string> names;
  const std::string help = beltpick_run("--help").out;
  const std::regex line("\n  ([a-z]+) {2,}[a-z]");
  for (std::sregex_iterator at(help.begin(), help.end(), line), end; at != end; ++at) names.push_back((*at)[1]);
  return names;
}

}  // namespace beltpick::test
