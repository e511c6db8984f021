// What the firmware tells of itself: why it started, and the check of its own flash; and its end, in the boot loader.
#pragma once

#include <stdint.h>

#include "protocol/messages.hpp"

namespace beltpick {
namespace avr {

// protocol::ResetBit, as the microcontroller had them at the start.
uint8_t reset_cause();

// CRC-16 of the program and its initial data, as they lie in the flash.
uint16_t flash_crc();

// Whether they are what the record behind them (boot/record.hpp) says.
protocol::FlashState flash_state();

// By a reset, which ends whatever the pins do. A board without the boot loader starts the firmware again.
[[noreturn]] void enter_loader();

}  // namespace avr
}  // namespace beltpick
