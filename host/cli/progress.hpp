// A progress bar on a terminal for what takes over a second; silent elsewhere.
#pragma once

#include <string>

#include "base/clock.hpp"

namespace beltpick::cli {

class Progress {
 public:
  // `what` is being done in `total` steps. Nothing is drawn with `quiet` or where stderr is no terminal.
  Progress(std::string what, int total, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` steps are done.
  void show(int done);

 private:
  std::string what_;
  int total_;
  bool silent_;
  bool drawn_ = false;
  double last_ms_ = 0.0;
  Stopwatch watch_;
};

}  // namespace beltpick::cli
