// PinWires: the wires from the emulated board's pins to the cell in the other process.
#pragma once

#include "emulator/chip.hpp"
#include "emulator/live_chip.hpp"
#include "host/pin_link.hpp"

namespace emulator {

class PinWires {
 public:
  // Takes over the chip's on_edge, and tells the cell that the board is ready. `chip` must run in `live`.
  PinWires(Chip& chip, LiveChip& live, beltpick::host::PinLink& link);

  // Does what the cell has asked for since the last call. False when the cell is gone.
  bool serve();

 private:
  void on_edge(const PinEdge& edge);
  void take(const beltpick::host::PinMessage& message);
  void set_input(const beltpick::host::PinMessage& message);

  Chip& chip_;
  LiveChip& live_;
  beltpick::host::PinLink& link_;
  bool gone_ = false;
  bool hang_wanted_ = false;
  int resets_told_ = 0;
};

}  // namespace emulator
