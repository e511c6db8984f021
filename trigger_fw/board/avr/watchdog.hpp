// The watchdog's timed sequences. avr-libc's own choose between two instructions by a constant, of which clang refuses
// the one that is not taken.
#pragma once

#include <avr/io.h>
#include <stdint.h>

namespace beltpick {
namespace avr {

__attribute__((always_inline)) inline void feed_watchdog() { __asm__ volatile("wdr"); }

// The second write must follow the first within four cycles. With interrupts off.
__attribute__((always_inline)) inline void set_watchdog(uint8_t control) {
  __asm__ volatile(
      "wdr"
      "\n\tsts %[at], %[open]"
      "\n\tsts %[at], %[control]" ::[at] "n"(_SFR_MEM_ADDR(WDTCSR)),
      [open] "r"(static_cast<uint8_t>(1U << WDCE | 1U << WDE)), [control] "r"(control));
}

constexpr uint8_t kWatchdogOff = 0;
constexpr uint8_t kWatchdog15ms = 1U << WDE;
constexpr uint8_t kWatchdog250ms = 1U << WDE | 1U << WDP2;

}  // namespace avr
}  // namespace beltpick
