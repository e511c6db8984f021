// The board's ticks of half a microsecond, from the 16-bit edge timer and its overflows; and the timer that wakes the
// main loop.
#pragma once

#include <stdint.h>

#include "pins.hpp"

namespace beltpick {
namespace avr {

void start_clock();

// Not from an interrupt.
uint32_t now_ticks();

// The time of a count of the edge timer that passed less than 32 ms ago.
uint32_t ticks_of_count(uint16_t count);

// Wakes the main loop after about this time (at once when it is over), after a millisecond at the latest.
void wake_in(int32_t span_ticks);

// Interrupts that leave work to the main loop say so; the main loop sleeps only when none has.
extern volatile bool work_waits;

}  // namespace avr
}  // namespace beltpick
