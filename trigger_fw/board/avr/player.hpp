// The player: drives the camera's and the projector's pin by the timer's compare matches. The main loop hands it edges
// ahead of time; when one is due the hardware moves the pin, and the interrupt behind it only prepares the next.
//
// Toggle mode with the port's bit kept in step: disconnecting the timer leaves the pin as it is, and clearing the
// port's bits makes it safe.
#pragma once

#include <stdint.h>

#include "pins.hpp"

namespace beltpick {
namespace avr {

// Edges further ahead than this wait: compare values and the timer's count are compared within half their range.
constexpr uint32_t kHorizon_us = 15000;
// An edge must be handed over this long before its time.
constexpr uint32_t kHandover_us = 20;
// The shortest interval between two edges of a pin: longer than the latest interrupt behind the first.
constexpr uint16_t kMinInterval_us = 50;
// The shortest period: the main loop hands over four frames ahead, and may be busy with messages meanwhile.
constexpr uint16_t kMinPeriod_us = 500;

void start_player();

enum class Handed : uint8_t { kTaken, kFull, kTooLate };
// Each edge moves the pin to its other level. `now_ticks` as read just before.
Handed hand_camera_edge(uint32_t at_ticks, uint32_t now_ticks);
Handed hand_projector_edge(uint32_t at_ticks, uint32_t now_ticks);

// Both pins low, at once, and nothing more to play. Leaves the timer ready for the next sequence.
void stop_player();

// Both pins low and no interrupt to move them. Inlined into interrupts: a call would make them save every register.
BELTPICK_INLINE void make_pins_safe() {
  EdgeTimer::control_a() = 0;
  CameraPin::clear();
  ProjectorPin::clear();
  EdgeTimer::interrupts() &= static_cast<uint8_t>(~(1U << OCIE1A | 1U << OCIE1B));
}

extern volatile bool player_tripped;

// What the emergency stop's interrupt does. The player refuses edges until release_player().
BELTPICK_INLINE void trip_player() {
  make_pins_safe();
  player_tripped = true;
}
void release_player();

// True once when an edge could not be prepared in time: the pins are safe then.
bool take_late_edge();

}  // namespace avr
}  // namespace beltpick
