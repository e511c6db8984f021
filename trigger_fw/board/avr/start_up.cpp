#include "start_up.hpp"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>

#include "boot/flash_memory.hpp"
#include "boot/handover.hpp"
#include "watchdog.hpp"

// The linker's mark behind the last byte of the program. Its address is what counts.
extern "C" const char __data_load_end;

namespace {
// Before the memory is cleared, and outside of what is.
uint8_t cause __attribute__((section(".noinit")));
}  // namespace

// After a watchdog's reset the watchdog still runs, at its shortest time: it must be stopped before anything else.
extern "C" void beltpick_save_reset_cause() __attribute__((used, externally_visible));
extern "C" void beltpick_save_reset_cause() {
  cause = MCUSR;
  if (cause == 0) cause = beltpick::boot::saved_reset_cause();
  // A board without the loader comes straight back from enter_loader(): its watchdog has not caught a hang.
  if (beltpick::boot::loader_wish() == beltpick::boot::kLoaderWish) cause = beltpick::protocol::kResetExternal;
  MCUSR = 0;
  beltpick::avr::set_watchdog(beltpick::avr::kWatchdogOff);
}

// Part of the start-up code, which the linker joins from such sections: it falls through to the next.
extern "C" void beltpick_before_memory() __attribute__((naked, used, externally_visible, section(".init3")));
extern "C" void beltpick_before_memory() { __asm__ volatile("call beltpick_save_reset_cause"); }

namespace beltpick {
namespace avr {

uint8_t reset_cause() { return cause; }

uint16_t flash_crc() {
  const uint16_t end = reinterpret_cast<uint16_t>(&__data_load_end);
  uint16_t crc = protocol::kCrcStart;
  for (uint16_t at = 0; at < end; ++at) crc = protocol::crc16_step(crc, pgm_read_byte(at));
  return crc;
}

protocol::FlashState flash_state() {
  bool sealed = false;
  for (uint8_t i = 0; i < boot::kRecordBytes; ++i) {
    sealed = sealed || boot::read_flash(static_cast<boot::FlashAddress>(boot::record_address(boot::kChip) + i)) != 0xFF;
  }
  if (!sealed) return protocol::FlashState::kUnsealed;
  return boot::firmware_is_whole() ? protocol::FlashState::kWhole : protocol::FlashState::kDamaged;
}

void enter_loader() {
  cli();
  boot::loader_wish() = boot::kLoaderWish;
  set_watchdog(kWatchdog15ms);
  while (true) {
  }
}

}  // namespace avr
}  // namespace beltpick
