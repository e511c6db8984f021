// The firmware of the AVR boards: the main loop that feeds the core, and hands the edges of a running sequence to the
// player ahead of their time. All of the core runs here; interrupts only move bytes, ticks and pins.
#include <avr/sleep.h>
#include <util/atomic.h>

#include "clock.hpp"
#include "core/device.hpp"
#include "inputs.hpp"
#include "player.hpp"
#include "serial.hpp"
#include "start_up.hpp"
#include "watchdog.hpp"

namespace beltpick {
namespace avr {
namespace {

core::BoardTiming board_timing() {
  core::BoardTiming timing;
  timing.start_lead_us = 1000;
  // The player drives the edges and tells itself when one is late; the core follows as the main loop finds time.
  timing.late_limit_us = 20000;
  timing.min_interval_us = kMinInterval_us;
  timing.min_exposure_us = kMinInterval_us;
  timing.min_period_us = kMinPeriod_us;
  return timing;
}

protocol::Identity identity() {
  protocol::Identity identity;
  identity.board = kBoardKind;
  constexpr uint8_t kVersion[] = {BELTPICK_FIRMWARE_VERSION};
  identity.firmware_major = kVersion[0];
  identity.firmware_minor = kVersion[1];
  identity.firmware_patch = kVersion[2];
  identity.reset_cause = reset_cause();
  identity.flash_crc = flash_crc();
  identity.flash_state = flash_state();
  return identity;
}

class Firmware {
 public:
  Firmware() : device_(identity(), read_inputs(), now_ticks(), board_timing()) {
    device_.sequencer().on_strobe(StrobePin::read(), now_ticks());
  }

  // Pins before bytes: putting a message together takes half a millisecond.
  void turn() {
    feed_watchdog();
    follow_pins();
    if (take_late_edge()) sequencer().on_late_edge();
    play();
    show();
    exchange_bytes();
    if (device_.loader_due() && ring_is_sent()) enter_loader();
    sleep();
  }

 private:
  core::Sequencer& sequencer() { return device_.sequencer(); }

  // The time is read first, and everything is told in the order in which it happened: what strobes did up to then is
  // known before their deadlines are judged, and a strobe that the emergency stop cut short is no fault of the strobe.
  void follow_pins() {
    const uint32_t now = now_ticks();
    uint16_t pressed_at;
    if (take_emergency_stop(pressed_at)) {
      const uint32_t stop_ticks = ticks_of_count(pressed_at);
      follow_strobe(stop_ticks);
      sequencer().on_inputs(read_inputs() | protocol::kInputEmergencyStop, stop_ticks);
      release_player();
    }
    follow_strobe(now);
    sequencer().on_inputs(read_inputs(), now);  // and serves what is due by then
    if (take_start()) sequencer().start_by_pin(odd(now_ticks()));
  }

  void follow_strobe(uint32_t until_ticks) {
    StrobeEdge edge;
    while (next_strobe_edge(edge)) {
      const uint32_t at_ticks = ticks_of_count(edge.tick);
      if (static_cast<int32_t>(at_ticks - until_ticks) > 0) return;
      sequencer().on_strobe(edge.level, at_ticks);
      drop_strobe_edge();
    }
  }

  // What starts at an odd tick has all its edges at odd ones: none then falls on the timer's count 0, which simulators
  // never match.
  static uint32_t odd(uint32_t ticks) { return ticks | 1U; }

  void exchange_bytes() {
    uint8_t byte;
    uint8_t left = kBytesPerTurn;
    const uint32_t now = odd(now_ticks());
    while (left > 0 && receive(byte)) {
      device_.on_byte(byte, now);
      --left;
      work_waits = true;  // it may have been a request, and there may be more
    }
    for (left = protocol::kMaxOutgoingFrame; left > 0 && can_send() && device_.next_byte(byte); --left) send(byte);
    if (left == 0) work_waits = true;
  }

  void play() {
    if (sequencer().running()) {
      if (!playing_) walk_.start(sequencer().start_ticks());
      playing_ = true;
      hand_edges();
    }
    if (playing_ && !sequencer().running()) {
      stop_player();
      playing_ = false;
    }
  }

  void hand_edges() {
    while (walk_.edge() != core::Edge::kSequenceEnds) {
      const uint32_t now = now_ticks();
      if (static_cast<int32_t>(walk_.at_ticks() - now) > static_cast<int32_t>(core::ticks_of(kHorizon_us))) return;
      const bool of_camera = walk_.edge() == core::Edge::kPulseRises || walk_.edge() == core::Edge::kPulseFalls;
      const Handed handed =
          of_camera ? hand_camera_edge(walk_.at_ticks(), now) : hand_projector_edge(walk_.at_ticks(), now);
      if (handed == Handed::kTooLate) sequencer().on_late_edge();
      if (handed != Handed::kTaken) return;
      walk_.pass(sequencer().plan());
    }
  }

  // The pins that no timer drives. Those that the emergency stop's interrupt has set stay until the core knows of it.
  void show() {
    const core::Outputs out = sequencer().outputs();
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
      if (!emergency_stop_waits()) {
        BusyPin::write(out.busy);
        DonePin::write(out.done);
        FaultPin::write(out.fault);
      }
    }
  }

  void sleep() {
    uint32_t at_ticks;
    wake_in(sequencer().next_deadline(at_ticks) ? static_cast<int32_t>(at_ticks - now_ticks()) : 2000);
    cli();
    if (!work_waits) {
      sleep_enable();
      sei();  // takes effect behind the next instruction: no interrupt slips in between
      sleep_cpu();
      sleep_disable();
    }
    sei();
    work_waits = false;
  }

  // Few enough that the pins are followed in time under a full line.
  static constexpr uint8_t kBytesPerTurn = 16;

  core::Device device_;
  core::EdgeWalk walk_;
  bool playing_ = false;
};

}  // namespace
}  // namespace avr
}  // namespace beltpick

int main() {
  using namespace beltpick::avr;
  BusyPin::drive();
  DonePin::drive();
  FaultPin::drive();
  start_player();
  start_clock();
  start_inputs();
  start_serial();
  static Firmware firmware;
  set_watchdog(kWatchdog250ms);
  SMCR = 0;  // sleep means idle: timers and serial line run on
  sei();
  while (true) firmware.turn();
}
