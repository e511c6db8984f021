// TriggerBoard: the trigger box as the rest of the virtual cell has it: output edges, input levels, a serial line.
// There are two: the firmware's core on this PC, and the firmware's real ELF in an emulated microcontroller.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/result.hpp"
#include "host/pin_edge.hpp"

namespace beltpick::virtual_cell {

// Called in a thread of the board for every edge of an output, in order; may call the board, must not block.
using OnEdge = std::function<void(const host::PinEdge&)>;

class TriggerBoard {
 public:
  virtual ~TriggerBoard() = default;

  // The serial line, for the appliance to open.
  [[nodiscard]] virtual std::string tty() const = 0;

  // Input pins; from any thread. The strobe is exact when it is set within OnEdge.
  virtual void set_strobe(bool active) = 0;
  virtual void set_belt_stopped(bool stopped) = 0;
  virtual void set_emergency_stop(bool pressed) = 0;

  // What breaks on the board and its cable; from any thread.
  virtual void hang() = 0;                        // the main loop stands still, until the watchdog's reset
  virtual void set_line_noise(double share) = 0;  // of the bytes that are damaged, each way
  virtual void cut_line(bool cut) = 0;            // the serial cable
};

// Which of the two, and what the emulated one needs.
struct TriggerBoardChoice {
  bool emulated = false;
  std::string emulator;  // the program
  std::string firmware;  // the ELF file that runs in it
};

// Powers a board up: the belt stands, the emergency stop is released. `link`: where a link to the tty is made, empty
// for none. kServiceUnreachable where there is no pseudo-terminal, or the emulator does not start.
Result<std::unique_ptr<TriggerBoard>> make_trigger_board(const TriggerBoardChoice& choice, const std::string& link,
                                                         OnEdge on_edge);

}  // namespace beltpick::virtual_cell
