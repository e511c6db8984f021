// The inputs: strobe edges with the tick of the timer's input capture, emergency stop, START, belt stopped.
#pragma once

#include <stdint.h>

#include "pins.hpp"

namespace beltpick {
namespace avr {

struct StrobeEdge {
  bool level;
  uint16_t tick;
};

void start_inputs();

// The oldest edge of the strobe; false when there is none. It stays the oldest until it is dropped.
bool next_strobe_edge(StrobeEdge& edge);
void drop_strobe_edge();

// protocol::InputBit, as the pins are.
uint8_t read_inputs();

// True once after the emergency stop was pressed, however shortly, with the timer's tick. The outputs are safe by then.
bool take_emergency_stop(uint16_t& tick);

// True while take_emergency_stop() has something to tell.
bool emergency_stop_waits();

// True once after the START input fell.
bool take_start();

}  // namespace avr
}  // namespace beltpick
