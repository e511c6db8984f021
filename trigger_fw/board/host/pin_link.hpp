// PinLink: the wires between an emulated microcontroller and the cell around it, as messages over a socket between two
// processes.
//
// The board tells every edge of an output with its own clock's cycle, and its time stands still until the cell answers
// kGoOn: what the cell's devices do upon an edge then reaches the board at the very cycle, however late either process
// was.
#pragma once

#include <cstdint>

#include <string>

#include "host/pin_edge.hpp"

namespace beltpick::host {

inline constexpr std::uint64_t kCyclesPerUs = 16;  // of the emulated boards

struct PinMessage {
  enum class Kind : std::uint8_t {
    // From the board.
    kReady,  // its firmware has started and its serial line is there
    kEdge,   // `pin` (host::Pin) went to `level` at `cycle`; awaits kGoOn
    kReset,  // its watchdog has reset it at `cycle`
    // To the board.
    kGoOn,
    kInput,  // `pin` (InputPin) goes to `level`, `cycle` cycles from the edge under way, or from now
    kHang,   // its main loop stands still from now on, for the watchdog to find
    kNoise,  // of a million bytes on its serial line this many (`cycle`) are flipped or dropped, each way
    kMute,   // its serial line is cut (`level` true), or whole
  };
  Kind kind = Kind::kReady;
  std::uint8_t pin = 0;
  std::uint8_t level = 0;
  std::uint64_t cycle = 0;
};

// As signals, not as levels of a pin: true is active.
enum class InputPin : std::uint8_t { kStrobe, kEmergencyStop, kStart, kBeltStopped };

// One end of a SOCK_SEQPACKET pair.
class PinLink {
 public:
  // Owns the socket from here on.
  explicit PinLink(int fd) : fd_(fd) {}
  ~PinLink();
  PinLink(const PinLink&) = delete;
  PinLink& operator=(const PinLink&) = delete;

  // Our end, for poll().
  [[nodiscard]] int fd() const { return fd_; }

  // From any thread; false when the other side is gone.
  bool send(const PinMessage& message);

  enum class Received : std::uint8_t { kMessage, kNothing, kGone };
  // The next message; waits for it where `wait` is true.
  Received receive(PinMessage& message, bool wait);
  // In place of kReady: why the board cannot start.
  void send_failure(const std::string& why);
  // Waits for kReady, at most so long. Empty when it came, else why not.
  std::string await_ready(int timeout_ms);
  // Both sides find the other gone.
  void hang_up();

 private:
  int fd_;
};

}  // namespace beltpick::host
