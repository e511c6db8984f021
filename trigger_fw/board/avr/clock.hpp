// The board's microseconds, from the 16-bit edge timer (half a microsecond a tick) and its overflows; and the timer
// that wakes the main loop.
#pragma once

#include <stdint.h>

#include "pins.hpp"

namespace beltpick {
namespace avr {

constexpr uint16_t kTick_ns = 500;

void start_clock();

// Not from an interrupt.
uint32_t now_us();

// The compare value of a time. Always odd, half a microsecond late for every edge alike: value 0, which simulators
// never match, does not occur.
inline uint16_t tick_of(uint32_t at_us) { return static_cast<uint16_t>(at_us << 1U | 1U); }

// The time of a tick that passed less than 32 ms ago.
uint32_t us_of(uint16_t tick);

// Wakes the main loop after about this time, after a millisecond at the latest.
void wake_in(uint32_t span_us);

// Interrupts that leave work to the main loop say so; the main loop sleeps only when none has.
extern volatile bool work_waits;

}  // namespace avr
}  // namespace beltpick
