#include "player.hpp"

#include <util/atomic.h>

#include "clock.hpp"
#include "core/plan.hpp"

namespace beltpick {
namespace avr {

volatile bool player_tripped = false;

namespace {

volatile bool late = false;

struct Camera {
  using Out = CameraPin;
  static constexpr uint8_t kToggle = 1U << COM1A0;
  static constexpr uint8_t kInterrupt = 1U << OCIE1A;
  static volatile uint16_t& compare() { return EdgeTimer::compare_camera(); }
};

struct Projector {
  using Out = ProjectorPin;
  static constexpr uint8_t kToggle = 1U << COM1B0;
  static constexpr uint8_t kInterrupt = 1U << OCIE1B;
  static volatile uint16_t& compare() { return EdgeTimer::compare_projector(); }
};

// One pin's edges: the first is in the compare register, the others wait behind it.
template <class Hardware>
class Channel {
 public:
  // With interrupts off.
  Handed hand(uint16_t tick, uint32_t ahead_ticks) {
    if (player_tripped) return Handed::kFull;
    if (count_ == kRing) return Handed::kFull;
    if (count_ == 0) {
      if (static_cast<int32_t>(ahead_ticks) < static_cast<int32_t>(core::ticks_of(kHandover_us)))
        return Handed::kTooLate;
      prepare(tick);
    }
    ticks_[static_cast<uint8_t>(head_ + count_) & (kRing - 1U)] = tick;
    count_ = static_cast<uint8_t>(count_ + 1);
    return Handed::kTaken;
  }

  // After a match: the pin has moved.
  BELTPICK_INLINE void played() {
    // A flag of an older match of the same count, from before the edge was prepared, is no edge.
    const uint8_t count = count_;
    if (count == 0) return;
    uint8_t at = head_;
    const uint16_t now = EdgeTimer::count();
    if (static_cast<int16_t>(now - ticks_[at]) < 0) return;
    Hardware::Out::write(Hardware::Out::read());
    at = next(at);
    head_ = at;
    const uint8_t left = static_cast<uint8_t>(count - 1U);
    count_ = left;
    if (left == 0) {
      disconnect();
      return;
    }
    const uint16_t tick = ticks_[at];
    Hardware::compare() = tick;
    if (static_cast<int16_t>(tick - now) < kLeast) {
      late = true;
      make_pins_safe();
    }
  }

  void forget() { count_ = 0; }

 private:
  static constexpr uint8_t kRing = 8;
  static constexpr int16_t kLeast = 16;  // ticks that an edge must lie ahead for its compare value to be in place

  static void prepare(uint16_t tick) {
    Hardware::compare() = tick;
    EdgeTimer::control_a() |= Hardware::kToggle;
    EdgeTimer::interrupts() |= Hardware::kInterrupt;
  }
  static void disconnect() {
    EdgeTimer::control_a() &= static_cast<uint8_t>(~Hardware::kToggle);
    EdgeTimer::interrupts() &= static_cast<uint8_t>(~Hardware::kInterrupt);
  }

  static uint8_t next(uint8_t index) { return static_cast<uint8_t>((index + 1U) & (kRing - 1U)); }

  volatile uint16_t ticks_[kRing] = {};
  volatile uint8_t head_ = 0;
  volatile uint8_t count_ = 0;
};

Channel<Camera> camera;
Channel<Projector> projector;

}  // namespace

void start_player() {
  CameraPin::clear();
  ProjectorPin::clear();
  stop_player();
}

Handed hand_camera_edge(uint32_t at_ticks, uint32_t now_ticks) {
  const uint16_t tick = static_cast<uint16_t>(at_ticks);
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { return camera.hand(tick, at_ticks - now_ticks); }
  return Handed::kFull;
}

Handed hand_projector_edge(uint32_t at_ticks, uint32_t now_ticks) {
  const uint16_t tick = static_cast<uint16_t>(at_ticks);
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { return projector.hand(tick, at_ticks - now_ticks); }
  return Handed::kFull;
}

// The timer keeps a level of its own for each pin, which a broken-off pulse leaves high. It is forced low while the
// pins are released, so that nothing shows outside.
void stop_player() {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    make_pins_safe();
    camera.forget();
    projector.forget();
    CameraPin::release();
    ProjectorPin::release();
    EdgeTimer::control_a() = 1U << COM1A1 | 1U << COM1B1;
    EdgeTimer::control_c() = 1U << FOC1A | 1U << FOC1B;
    EdgeTimer::control_a() = 0;
    CameraPin::drive();
    ProjectorPin::drive();
  }
}

void release_player() { player_tripped = false; }

bool take_late_edge() {
  const bool was = late;
  late = false;
  return was;
}

}  // namespace avr
}  // namespace beltpick

ISR(BELTPICK_VECTOR_CAMERA) {
  beltpick::avr::camera.played();
  beltpick::avr::work_waits = true;
  sei();  // while the registers come back, the emergency stop need not wait
}

ISR(BELTPICK_VECTOR_PROJECTOR) {
  beltpick::avr::projector.played();
  beltpick::avr::work_waits = true;
  sei();
}
