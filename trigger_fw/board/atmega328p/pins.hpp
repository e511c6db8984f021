// ATmega328P at 16 MHz, the smallest board (Arduino Uno and Nano have its pins).
//
//   signal             pin          connector  electrically
//   camera trigger     PB1 (OC1A)   D9         high while the camera shall expose
//   projector advance  PB2 (OC1B)   D10        rises for each pattern
//   exposure strobe    PB0 (ICP1)   D8         high while the camera exposes
//   emergency stop     PD2 (INT0)   D2         low: released; high or open: pressed
//   START              PD3 (INT1)   D3         falls: start what is armed
//   belt stopped       PD4          D4         low: stands; high or open: moves
//   BUSY               PD5          D5         high while a sequence runs
//   DONE               PD6          D6         high after a whole sequence
//   FAULT              PD7          D7         high while a fault is latched
//   serial line        PD0, PD1     USB        500000 baud
//
// Outputs need a pull-down of 10 kOhm: until the firmware runs, and after a reset, the pins float. Inputs have the
// microcontroller's pull-up (the strobe none): a broken wire reads as "belt moves" and "stop pressed".
#pragma once

#include <avr/interrupt.h>

#include "pin.hpp"
#include "protocol/messages.hpp"

// For the emergency stop's few instructions: who moves the pins, and the port that both of them are on.
#define BELTPICK_ADDRESS_CONTROL_A _SFR_MEM_ADDR(TCCR1A)
#define BELTPICK_BUSY_PORT _SFR_IO_ADDR(PORTD)
#define BELTPICK_BUSY_BIT 5
#define BELTPICK_ADDRESS_PULSE_PORT _SFR_MEM_ADDR(PORTB)

namespace beltpick {
namespace avr {

constexpr protocol::BoardKind kBoardKind = protocol::BoardKind::kAtmega328p;

BELTPICK_PIN(CameraPin, B, 1);
BELTPICK_PIN(ProjectorPin, B, 2);
BELTPICK_PIN(StrobePin, B, 0);
BELTPICK_PIN(EmergencyStopPin, D, 2);
BELTPICK_PIN(StartPin, D, 3);
BELTPICK_PIN(BeltStoppedPin, D, 4);
BELTPICK_PIN(BusyPin, D, BELTPICK_BUSY_BIT);
BELTPICK_PIN(DonePin, D, 6);
BELTPICK_PIN(FaultPin, D, 7);

// The 16-bit timer of the edges. The bits lie as in timer 1 for all of them.
struct EdgeTimer {
  static volatile uint8_t& control_a() { return TCCR1A; }
  static volatile uint8_t& control_b() { return TCCR1B; }
  static volatile uint8_t& control_c() { return TCCR1C; }
  static volatile uint8_t& interrupts() { return TIMSK1; }
  static volatile uint8_t& flags() { return TIFR1; }
  static volatile uint16_t& count() { return TCNT1; }
  static volatile uint16_t& capture() { return ICR1; }
  static volatile uint16_t& compare_camera() { return OCR1A; }
  static volatile uint16_t& compare_projector() { return OCR1B; }
};

// The emergency stop has the first interrupt of all, START the second; the belt wakes the main loop.
inline void enable_input_interrupts() {
  EICRA = 1U << ISC01 | 1U << ISC00 | 1U << ISC11;  // rising edge of INT0, falling edge of INT1
  EIMSK = 1U << INT0 | 1U << INT1;
  PCMSK2 = 1U << PCINT20;
  PCICR = 1U << PCIE2;
}

}  // namespace avr
}  // namespace beltpick

#define BELTPICK_VECTOR_EMERGENCY_STOP INT0_vect
#define BELTPICK_VECTOR_START INT1_vect
#define BELTPICK_VECTOR_BELT PCINT2_vect
#define BELTPICK_VECTOR_CAMERA TIMER1_COMPA_vect
#define BELTPICK_VECTOR_PROJECTOR TIMER1_COMPB_vect
#define BELTPICK_VECTOR_CAPTURE TIMER1_CAPT_vect
#define BELTPICK_VECTOR_OVERFLOW TIMER1_OVF_vect
#define BELTPICK_VECTOR_RECEIVED USART_RX_vect
#define BELTPICK_VECTOR_SENDABLE USART_UDRE_vect
