// Board: the trigger firmware's core running on this PC in real time, for the virtual cell. Its serial line is a
// pseudo-terminal, its output pins are a callback, its input pins are setters; wires can be cut.
//
// Its clock stands still while the PC is late: an edge that the scheduler delays is served at its own board time and
// all later ones move with it. So the board keeps its time exactly on a loaded PC, and edges never come closer
// than armed.
//
//   host::Board board({.link = "/tmp/trigger", .belt_stopped = true, .on_edge = [&](const host::PinEdge& edge) {
//     if (edge.pin != host::Pin::kCameraTrigger) return;
//     camera.line(edge.level, edge.board_us);
//     board.set_strobe(edge.level);
//   }});
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/device.hpp"
#include "host/line_noise.hpp"
#include "host/pin_edge.hpp"
#include "host/pseudo_terminal.hpp"

namespace beltpick::host {

struct BoardOptions {
  std::string link;           // where a link to the tty is made; empty for none
  bool belt_stopped = false;  // inputs at power-up
  bool emergency_stop = false;
  // Called on the board's thread for every edge, in the order of the wires; may call the setters, must not block.
  std::function<void(const PinEdge&)> on_edge;
};

class Board {
 public:
  // Powers the board up. Throws std::system_error when there is no pseudo-terminal to be had.
  explicit Board(BoardOptions options);
  ~Board();
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  // The serial line, for the appliance to open.
  [[nodiscard]] const std::string& tty() const { return terminal_.tty(); }

  // Input pins; from any thread. The strobe is exact when it is set within on_edge.
  void set_strobe(bool active);
  void set_belt_stopped(bool stopped);
  void set_emergency_stop(bool pressed);

  // Fault switches; from any thread.
  void mute(bool muted) { muted_ = muted; }                               // the serial line is cut, both ways
  void set_noise(double share) { noise_share_ = share; }                  // of its bytes are damaged, each way
  void hang() { hang_wanted_ = true; }                                    // until the watchdog's reset
  void drop_strobes(int count) { strobes_to_drop_ = count; }              // the next ones do not reach the board
  void drop_camera_pulses(int count) { pulses_to_drop_ = count; }         // the next ones do not reach the camera
  void drop_projector_advances(int count) { advances_to_drop_ = count; }  // the next ones do not reach the projector

  // What a STATUS request would tell.
  [[nodiscard]] protocol::StatusReport status();

 private:
  struct WireFault {
    std::atomic<int>& left;
    bool& cut;  // this pulse is being swallowed
  };

  void run();
  void hang_and_restart();
  void wait();
  void publish(bool serving);
  std::int64_t serve();
  void emit_changes(const core::Outputs& out, std::uint32_t board_us);
  void emit(Pin pin, bool level, std::uint32_t board_us);
  void receive();
  void transmit();
  void set_input(std::uint8_t bit, bool level);
  void wake();
  static bool swallowed(WireFault fault, bool level);
  static std::uint32_t core_ticks(std::int64_t ticks);
  [[nodiscard]] std::int64_t raw_ticks() const;
  [[nodiscard]] std::int64_t board_ticks() const;
  [[nodiscard]] std::optional<std::int32_t> late_by(std::int64_t ticks) const;

  BoardOptions options_;
  PseudoTerminal terminal_;
  int wake_fd_ = -1;

  std::mutex mutex_;  // guards what follows
  std::int64_t clock_zero_ns_ = 0;
  std::uint8_t inputs_ = 0;
  bool strobe_cut_ = false;
  core::Device device_;

  core::Outputs published_;  // the board thread's own
  bool pulse_cut_ = false;
  bool advance_cut_ = false;

  LineNoise noise_{1};

  std::atomic<bool> muted_{false};
  std::atomic<bool> hang_wanted_{false};
  std::atomic<double> noise_share_{0.0};
  std::atomic<int> strobes_to_drop_{0};
  std::atomic<int> pulses_to_drop_{0};
  std::atomic<int> advances_to_drop_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace beltpick::host
