// The virtual cell's fault switches while it runs: lines written to a FIFO.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "base/result.hpp"
#include "virtual_cell/world/plant.hpp"

namespace beltpick::cli {

class LiveSwitches {
 public:
  // Makes the FIFO at `path` and listens: the name of a fault breaks what it names until the line `mend`.
  // kFileNotWritten where there cannot be a FIFO.
  static Result<std::unique_ptr<LiveSwitches>> open(const std::string& path, virtual_cell::Plant& plant);
  ~LiveSwitches();
  LiveSwitches(const LiveSwitches&) = delete;
  LiveSwitches& operator=(const LiveSwitches&) = delete;

 private:
  LiveSwitches(std::string path, int fifo, virtual_cell::Plant& plant);

  void run();
  void obey(std::string_view line);

  const std::string path_;
  const int fifo_;
  virtual_cell::Plant& plant_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace beltpick::cli
