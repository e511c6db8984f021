// The serial line: 500000 baud, 8N1, both directions by interrupts through rings.
#pragma once

#include <stdint.h>

namespace beltpick {
namespace avr {

void start_serial();

// The next byte received; false when there is none. Bytes that the ring cannot take are lost, as on the wire.
bool receive(uint8_t& byte);

// True when the ring takes a byte; then send() it.
bool can_send();
void send(uint8_t byte);

// True when nothing waits in the ring; the last two bytes may still be on their way for 40 us.
bool ring_is_sent();

}  // namespace avr
}  // namespace beltpick
