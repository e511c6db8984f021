// What boot loader and firmware leave for each other in the microcontroller, over a reset or a jump.
#pragma once

#include <avr/io.h>
#include <stdint.h>

namespace beltpick {
namespace boot {

// The firmware's wish for the loader: in the first bytes of the RAM, which a watchdog's reset leaves as they are. They
// are the firmware's own data, but it does not come back from asking; the loader has none.
constexpr uint32_t kLoaderWish = 0x4C4F4144;
inline volatile uint32_t& loader_wish() { return *reinterpret_cast<volatile uint32_t*>(RAMSTART); }

// The loader must clear MCUSR to stop the watchdog; the cause of the reset waits here for the firmware.
inline volatile uint8_t& saved_reset_cause() { return GPIOR0; }

}  // namespace boot
}  // namespace beltpick
