#include "inputs.hpp"

#include <util/atomic.h>

#include "clock.hpp"
#include "player.hpp"

namespace beltpick {
namespace avr {

namespace {

constexpr uint8_t kStrobes = 8;
volatile uint16_t strobe_ticks[kStrobes];
volatile bool strobe_levels[kStrobes];
volatile uint8_t strobe_head = 0;
volatile uint8_t strobe_tail = 0;
volatile bool strobe_level = false;

volatile bool stop_pressed = false;
volatile uint16_t stop_tick = 0;
volatile bool start_fell = false;

// Waits for the edge that ends this level. Turning the capture can itself look like an edge; that one finds no new
// level.
BELTPICK_INLINE void await_end_of(bool level) {
  strobe_level = level;
  if (level) {
    EdgeTimer::control_b() &= static_cast<uint8_t>(~(1U << ICES1));
  } else {
    EdgeTimer::control_b() |= 1U << ICES1;
  }
}

BELTPICK_INLINE void note_strobe(bool level, uint16_t tick) {
  await_end_of(level);
  const uint8_t next = static_cast<uint8_t>((strobe_tail + 1U) % kStrobes);
  if (next == strobe_head) return;
  strobe_ticks[strobe_tail] = tick;
  strobe_levels[strobe_tail] = level;
  strobe_tail = next;
  work_waits = true;
}

}  // namespace

void start_inputs() {
  StrobePin::release();
  await_end_of(StrobePin::read());
  EmergencyStopPin::pull_up();
  StartPin::pull_up();
  BeltStoppedPin::pull_up();
  enable_input_interrupts();
}

// An edge within the few cycles in which the one before it turned the capture is not captured: the pin tells of it.
bool next_strobe_edge(StrobeEdge& edge) {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    const bool level = StrobePin::read();
    const bool captured = (EdgeTimer::flags() & 1U << ICF1) != 0;
    if (strobe_head == strobe_tail && level != strobe_level && !captured) note_strobe(level, EdgeTimer::count());
  }
  if (strobe_head == strobe_tail) return false;
  edge.level = strobe_levels[strobe_head];
  edge.tick = strobe_ticks[strobe_head];
  return true;
}

void drop_strobe_edge() { strobe_head = static_cast<uint8_t>((strobe_head + 1U) % kStrobes); }

uint8_t read_inputs() {
  uint8_t bits = 0;
  if (!BeltStoppedPin::read()) bits |= protocol::kInputBeltStopped;
  if (EmergencyStopPin::read()) bits |= protocol::kInputEmergencyStop;
  return bits;
}

bool take_emergency_stop(uint16_t& tick) {
  bool was;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    was = stop_pressed;
    tick = stop_tick;
    stop_pressed = false;
  }
  return was;
}

bool emergency_stop_waits() { return stop_pressed; }

bool take_start() {
  const bool was = start_fell;
  start_fell = false;
  return was;
}

}  // namespace avr
}  // namespace beltpick

// Takes both pins from the timer and pulls them low, and BUSY, before it saves what the rest needs.
ISR(BELTPICK_VECTOR_EMERGENCY_STOP, ISR_NAKED) {
  __asm__ volatile(
      "push r24"
      "\n\tin r24, __SREG__"
      "\n\tpush r24"
      "\n\tldi r24, 0"
      "\n\tsts %[control], r24"
      "\n\tlds r24, %[port]"
      "\n\tandi r24, %[others]"
      "\n\tsts %[port], r24"
      "\n\tcbi %[busy_port], %[busy_bit]"
      "\n\tpop r24"
      "\n\tout __SREG__, r24"
      "\n\tpop r24"
      "\n\tjmp __vector_emergency_stop_rest" ::[control] "i"(BELTPICK_ADDRESS_CONTROL_A),
      [port] "i"(BELTPICK_ADDRESS_PULSE_PORT), [busy_port] "I"(BELTPICK_BUSY_PORT), [busy_bit] "I"(BELTPICK_BUSY_BIT),
      [others] "n"(0xFF & ~(beltpick::avr::CameraPin::kMask | beltpick::avr::ProjectorPin::kMask)));
}

extern "C" void __vector_emergency_stop_rest() __attribute__((signal, used, externally_visible));
extern "C" void __vector_emergency_stop_rest() {
  using namespace beltpick::avr;
  trip_player();
  FaultPin::set();
  stop_tick = EdgeTimer::count();
  stop_pressed = true;
  work_waits = true;
}

ISR(BELTPICK_VECTOR_START) {
  beltpick::avr::start_fell = true;
  beltpick::avr::work_waits = true;
}

ISR(BELTPICK_VECTOR_BELT) { beltpick::avr::work_waits = true; }

ISR(BELTPICK_VECTOR_CAPTURE) {
  using namespace beltpick::avr;
  const uint16_t tick = EdgeTimer::capture();
  const bool level = StrobePin::read();
  if (level == strobe_level) return;
  note_strobe(level, tick);
  sei();  // while the registers come back, the emergency stop need not wait
}
