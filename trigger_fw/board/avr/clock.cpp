#include "clock.hpp"

#include <util/atomic.h>

namespace beltpick {
namespace avr {

volatile bool work_waits = true;

namespace {
volatile uint32_t overflows = 0;
}  // namespace

void start_clock() {
  EdgeTimer::control_a() = 0;
  EdgeTimer::control_b() = 1U << ICNC1 | 1U << ICES1 | 1U << CS11;  // a rising strobe first; 16 MHz / 8
  EdgeTimer::interrupts() = 1U << ICIE1 | 1U << TOIE1;
  TCCR0A = 0;
  TCCR0B = 1U << CS01 | 1U << CS00;  // 16 MHz / 64: four microseconds
  OCR0A = 0xFF;
  TIMSK0 = 1U << OCIE0A;
}

uint32_t now_us() {
  uint32_t high;
  uint16_t low;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    low = EdgeTimer::count();
    high = overflows;
    // An overflow whose interrupt has to wait.
    if ((EdgeTimer::flags() & 1U << TOV1) != 0 && low < 0x8000U) ++high;
  }
  // high << 15 | low >> 1, without the fifteen shifts.
  const uint32_t us = (high << 16U | low) >> 1U;
  return (high & 0x10000U) != 0 ? us | 0x80000000U : us;
}

uint32_t us_of(uint16_t tick) {
  const uint32_t now = now_us();
  const uint16_t ago = static_cast<uint16_t>(static_cast<uint16_t>(now << 1U) - tick);
  // A tick of this very moment may lie before the microsecond in which `now` was read.
  return ago >= 0xFFF0U ? now : now - (ago >> 1U);
}

void wake_in(uint32_t span_us) {
  uint8_t steps = 250;
  if (span_us < 1000) steps = static_cast<uint8_t>(2U + (static_cast<uint16_t>(span_us) >> 2U));
  uint8_t at = static_cast<uint8_t>(TCNT0 + steps);
  OCR0A = at != 0 ? at : 1;
}

}  // namespace avr
}  // namespace beltpick

ISR(BELTPICK_VECTOR_OVERFLOW) {
  // The time alone: the main loop is woken by what it waits for.
  beltpick::avr::overflows = beltpick::avr::overflows + 1;
}

ISR(TIMER0_COMPA_vect) { beltpick::avr::work_waits = true; }
