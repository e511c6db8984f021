// One pin of a port, as types: every access compiles to an instruction or two.
#pragma once

#include <avr/io.h>
#include <stdint.h>

namespace beltpick {
namespace avr {

// Whatever interrupts use must not become a call: they would then save every register.
#define BELTPICK_INLINE __attribute__((always_inline)) inline

template <class Location>
struct Pin {
  static constexpr uint8_t kMask = Location::kMask;
  BELTPICK_INLINE static void set() { Location::port() |= Location::kMask; }
  BELTPICK_INLINE static void clear() { Location::port() &= static_cast<uint8_t>(~Location::kMask); }
  BELTPICK_INLINE static void write(bool level) { level ? set() : clear(); }
  BELTPICK_INLINE static bool read() { return (Location::input() & Location::kMask) != 0; }
  BELTPICK_INLINE static void drive() { Location::direction() |= Location::kMask; }
  BELTPICK_INLINE static void release() { Location::direction() &= static_cast<uint8_t>(~Location::kMask); }
  // An input that an open wire leaves high.
  static void pull_up() {
    release();
    set();
  }
};

}  // namespace avr
}  // namespace beltpick

// BELTPICK_PIN(Busy, D, 5): the type Busy is bit 5 of port D.
#define BELTPICK_PIN(name, letter, bit)                                 \
  struct name##Location {                                               \
    static volatile uint8_t& port() { return PORT##letter; }            \
    static volatile uint8_t& direction() { return DDR##letter; }        \
    static volatile uint8_t& input() { return PIN##letter; }            \
    static constexpr uint8_t kMask = static_cast<uint8_t>(1U << (bit)); \
  };                                                                    \
  using name = Pin<name##Location>
