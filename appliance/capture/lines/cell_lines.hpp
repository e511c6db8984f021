// CellLines: the cell's wires on GPIO lines of this PC. A thread of its own follows the inputs by their edges; the
// permission "belt may move" is driven here. Lines that are not wired take no part: an input then reads as harmless.
//
// "Belt may move" is active only while it is asked for and neither emergency stop nor FAULT is active; it falls in the
// thread that sees them. When the process ends, in whatever way, the kernel takes the line back: what it then does
// belongs to the chip's driver and the wiring, so the line needs a pull to its inactive level.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "base/result.hpp"
#include "capture/lines/debounce.hpp"
#include "capture/lines/gpio.hpp"

namespace beltpick::capture {

struct CellLinesConfig {
  LineSpec belt_stopped{};    // input
  LineSpec emergency_stop{};  // input
  LineSpec busy{};            // input: of the microcontroller
  LineSpec fault{};           // input: of the microcontroller
  LineSpec belt_may_move{};   // output
  LineSpec start{};           // output: to the microcontroller
  int debounce_ms = 10;       // of belt_stopped and emergency_stop, see Debounce
};

struct CellInputs {
  bool known = false;  // false: the lines are lost; the levels are then the safe ones
  bool belt_stopped = false;
  bool emergency_stop = true;
  bool busy = false;
  bool fault = true;
  unsigned busy_rises = 0;      // since the start
  std::int64_t changed_us = 0;  // of belt_stopped or emergency_stop, by the kernel's stamp
};

// One wired line, for a person.
struct LineShown {
  const char* name = "";
  LineSpec spec;
  bool output = false;
  bool active = false;
};

class CellLines {
 public:
  explicit CellLines(const CellLinesConfig& config);
  ~CellLines();
  CellLines(const CellLines&) = delete;
  CellLines& operator=(const CellLines&) = delete;

  // Takes all wired lines; the outputs are inactive then. Errors: those of Gpio::request, of the first that fails.
  Result<void> open(Gpio& gpio);
  // Starts the thread, where there are inputs; after open().
  void start();

  [[nodiscard]] CellInputs inputs() const;
  // Why they are not known.
  [[nodiscard]] Error last_error() const;
  // Becomes readable when belt_stopped or emergency_stop changed; for one reader, who reads the eventfd.
  [[nodiscard]] int changed_fd() const { return changed_fd_; }

  // The permission; from any thread, as often as one likes.
  void permit_belt(bool may_move);
  [[nodiscard]] bool has_start() const { return start_ != nullptr; }
  [[nodiscard]] bool has_busy() const { return inputs_[kBusy].line != nullptr; }
  // A pulse of a millisecond on START.
  Result<void> pulse_start();

  // The wired lines and their levels now.
  [[nodiscard]] std::vector<LineShown> show() const;

 private:
  enum Input : std::uint8_t { kBeltStopped, kEmergencyStop, kBusy, kFault, kInputCount };
  struct Watched {
    const char* name;
    const LineSpec* spec;
    bool safe_level;
    bool debounced;
    std::unique_ptr<GpioLine> line;  // null: not wired
    Debounce level;
  };

  void run();
  void wait();
  Result<void> take_edges();
  void look_again();
  void publish();
  void drive_permission();
  void lose(const Error& error);

  CellLinesConfig config_;
  std::array<Watched, kInputCount> inputs_;  // the thread's own, once it runs
  std::unique_ptr<GpioLine> permission_, start_;
  int changed_fd_ = -1;
  int stop_fd_ = -1;

  std::atomic<bool> lost_{false};
  std::atomic<std::uint8_t> active_{0};  // bit 1 << Input
  std::atomic<unsigned> busy_rises_{0};
  std::atomic<std::int64_t> changed_us_{0};

  mutable std::mutex mutex_;  // guards what follows
  bool permitted_ = false;
  bool driven_ = false;
  Error error_;
  std::thread thread_;
};

}  // namespace beltpick::capture
