// Runs one of our programs as a stranger would: through the shell, seeing only exit code, stdout and stderr.
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "support/temp_folder.hpp"

namespace beltpick::test {

struct Outcome {
  int exit_code = -1;  // 128 + n where signal n ended it
  std::string out;
  std::string err;

  [[nodiscard]] std::ptrdiff_t error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
};

// `arguments` are the shell's, quoted by the caller; the program is one of build/bin.
inline Outcome run_program(const std::string& program, const std::string& arguments) {
  const TempFolder folder;
  const std::string command = std::string(BELTPICK_BIN_DIR) + "/" + program + " " + arguments + " >" +
                              (folder / "out").string() + " 2>" + (folder / "err").string() + " </dev/null";
  const int status = std::system(command.c_str());
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = file_bytes(folder / "out");
  outcome.err = file_bytes(folder / "err");
  return outcome;
}

inline Outcome beltpick_run(const std::string& arguments) { return run_program("beltpick", arguments); }

}  // namespace beltpick::test
