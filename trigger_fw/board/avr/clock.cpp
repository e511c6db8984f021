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

uint32_t now_ticks() {
  uint32_t high;
  uint16_t low;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    low = EdgeTimer::count();
    high = overflows;
    // An overflow whose interrupt has to wait.
    if ((EdgeTimer::flags() & 1U << TOV1) != 0 && low < 0x8000U) ++high;
  }
  return high << 16U | low;
}

uint32_t ticks_of_count(uint16_t count) {
  const uint32_t now = now_ticks();
  return now - static_cast<uint16_t>(static_cast<uint16_t>(now) - count);
}

void wake_in(int32_t span_ticks) {
  constexpr int32_t kTicksPerStep = 8;
  uint8_t steps = 250;
  if (span_ticks < 248 * kTicksPerStep) steps = 2;
  if (span_ticks > 0 && span_ticks < 248 * kTicksPerStep) {
    steps = static_cast<uint8_t>(2U + (static_cast<uint16_t>(span_ticks) >> 3U));
  }
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
