// What boot loader and firmware leave for each other in the microcontroller, over a reset or a jump.
#pragma once

#include <avr/io.h>
#include <stdint.h>

namespace beltpick {
namespace boot {

// The firmware's wish for the loader: in the last bytes of the RAM, which a watchdog's reset leaves as they are. The
// firmware's stack begins there, but it does not come back from asking.
constexpr uint32_t kLoaderWish = 0x4C4F4144;
inline volatile uint32_t& loader_wish() { return *reinterpret_cast<volatile uint32_t*>(RAMEND - 3); }

// The loader must clear MCUSR to stop the watchdog; the cause of the reset waits here for the firmware.
inline volatile uint8_t& saved_reset_cause() { return GPIOR0; }

}  // namespace boot
}  // namespace beltpick
