// A `beltpick flash` that runs beside the emulated board, and the hands that break it off.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace emulator {

class Flashing {
 public:
  // Starts it with these arguments, in a process group of its own.
  explicit Flashing(const std::vector<std::string>& arguments);
  ~Flashing();
  Flashing(const Flashing&) = delete;
  Flashing& operator=(const Flashing&) = delete;

  [[nodiscard]] bool runs();
  // At once and without a last word: the program and its avrdude, or avrdude alone.
  void kill_all();
  void kill_avrdude();
  // Waits for its end.
  beltpick::test::Outcome outcome();

 private:
  beltpick::test::TempFolder folder_;
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

}  // namespace emulator
