// ATmega2560 at 16 MHz, the product board (an Arduino Mega has its pins).
//
//   signal             pin          connector  electrically
//   camera trigger     PL3 (OC5A)   D46        high while the camera shall expose
//   projector advance  PL4 (OC5B)   D45        rises for each pattern
//   exposure strobe    PL1 (ICP5)   D48        high while the camera exposes
//   emergency stop     PD0 (INT0)   D21        low: released; high or open: pressed
//   START              PD1 (INT1)   D20        falls: start what is armed
//   belt stopped       PB4          D10        low: stands; high or open: moves
//   BUSY               PA0          D22        high while a sequence runs
//   DONE               PA1          D23        high after a whole sequence
//   FAULT              PA2          D24        high while a fault is latched
//   serial line        PE0, PE1     USB        500000 baud
//
// Outputs need a pull-down of 10 kOhm: until the firmware runs, and after a reset, the pins float. Inputs have the
// microcontroller's pull-up (the strobe none): a broken wire reads as "belt moves" and "stop pressed".
#pragma once

#include <avr/interrupt.h>

#include "pin.hpp"
#include "protocol/messages.hpp"

// For the emergency stop's few instructions: who moves the pins, and the port that both of them are on.
#define BELTPICK_ADDRESS_CONTROL_A _SFR_MEM_ADDR(TCCR5A)
#define BELTPICK_BUSY_PORT _SFR_IO_ADDR(PORTA)
#define BELTPICK_BUSY_BIT 0
#define BELTPICK_ADDRESS_PULSE_PORT _SFR_MEM_ADDR(PORTL)

namespace beltpick {
namespace avr {

constexpr protocol::BoardKind kBoardKind = protocol::BoardKind::kAtmega2560;

BELTPICK_PIN(CameraPin, L, 3);
BELTPICK_PIN(ProjectorPin, L, 4);
BELTPICK_PIN(StrobePin, L, 1);
BELTPICK_PIN(EmergencyStopPin, D, 0);
BELTPICK_PIN(StartPin, D, 1);
BELTPICK_PIN(BeltStoppedPin, B, 4);
BELTPICK_PIN(BusyPin, A, BELTPICK_BUSY_BIT);
BELTPICK_PIN(DonePin, A, 1);
BELTPICK_PIN(FaultPin, A, 2);

// The 16-bit timer of the edges. The bits lie as in timer 1 for all of them.
struct EdgeTimer {
  static volatile uint8_t& control_a() { return TCCR5A; }
  static volatile uint8_t& control_b() { return TCCR5B; }
  static volatile uint8_t& control_c() { return TCCR5C; }
  static volatile uint8_t& interrupts() { return TIMSK5; }
  static volatile uint8_t& flags() { return TIFR5; }
  static volatile uint16_t& count() { return TCNT5; }
  static volatile uint16_t& capture() { return ICR5; }
  static volatile uint16_t& compare_camera() { return OCR5A; }
  static volatile uint16_t& compare_projector() { return OCR5B; }
};

// The emergency stop has the first interrupt of all, START the second; the belt wakes the main loop.
inline void enable_input_interrupts() {
  EICRA = 1U << ISC01 | 1U << ISC00 | 1U << ISC11;  // rising edge of INT0, falling edge of INT1
  EIMSK = 1U << INT0 | 1U << INT1;
  PCMSK0 = 1U << PCINT4;
  PCICR = 1U << PCIE0;
}

}  // namespace avr
}  // namespace beltpick

#define BELTPICK_VECTOR_EMERGENCY_STOP INT0_vect
#define BELTPICK_VECTOR_START INT1_vect
#define BELTPICK_VECTOR_BELT PCINT0_vect
#define BELTPICK_VECTOR_CAMERA TIMER5_COMPA_vect
#define BELTPICK_VECTOR_PROJECTOR TIMER5_COMPB_vect
#define BELTPICK_VECTOR_CAPTURE TIMER5_CAPT_vect
#define BELTPICK_VECTOR_OVERFLOW TIMER5_OVF_vect
#define BELTPICK_VECTOR_RECEIVED USART0_RX_vect
#define BELTPICK_VECTOR_SENDABLE USART0_UDRE_vect
