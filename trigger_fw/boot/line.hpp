// The loader's end of the serial line, without interrupts: 500000 baud, 8N1.
#pragma once

#include <avr/io.h>
#include <util/delay.h>

namespace beltpick {
namespace boot {

inline void open_line() {
  UCSR0A = 1U << U2X0;
  UBRR0 = 3;  // exactly 500000 baud
  UCSR0C = 1U << UCSZ01 | 1U << UCSZ00;
  UCSR0B = 1U << RXEN0 | 1U << TXEN0;
}

// Waits for what was sent to be on the wire; the firmware finds the line as after a reset.
inline void close_line() {
  _delay_us(100);
  UCSR0B = 0;
}

inline void send(uint8_t byte) {
  while ((UCSR0A & 1U << UDRE0) == 0) {
  }
  UDR0 = byte;
}

// The next byte; false when none came for that long. Two bytes may wait in the hardware: 40 us.
inline bool receive(uint8_t& byte, uint16_t patience_ms) {
  do {
    for (uint8_t hundredths = 100; hundredths > 0; --hundredths) {
      if ((UCSR0A & 1U << RXC0) != 0) {
        byte = UDR0;
        return true;
      }
      _delay_us(9);
    }
  } while (--patience_ms > 0);
  return false;
}

}  // namespace boot
}  // namespace beltpick
