// The part of the STK500 protocol, version 1 (Atmel's application note AVR061), that avrdude needs of a boot loader
// (`-c arduino`). A request is a byte, its parameters and kEnd; an answer is kInSync, data and kOk.
#pragma once

#include <stdint.h>

namespace beltpick {
namespace boot {
namespace stk500 {

enum Request : uint8_t {
  kGetSync = 0x30,
  kGetParameter = 0x41,
  kSetDevice = 0x42,
  kSetDeviceExtended = 0x45,
  kEnterProgramming = 0x50,
  kLeaveProgramming = 0x51,
  kLoadAddress = 0x55,  // in words
  kUniversal = 0x56,    // four bytes as an in-system programmer sends them
  kProgramPage = 0x64,
  kReadPage = 0x74,
  kReadSignature = 0x75,
};
constexpr uint8_t kEnd = 0x20;
constexpr uint8_t kUniversalExtendedAddress = 0x4D;  // bits 16.. of the word address
constexpr uint8_t kMemoryFlash = 'F';

enum Answer : uint8_t { kOk = 0x10, kFailed = 0x11, kInSync = 0x14, kNoSync = 0x15 };

enum Parameter : uint8_t { kHardwareVersion = 0x80, kSoftwareMajor = 0x81, kSoftwareMinor = 0x82 };

}  // namespace stk500
}  // namespace boot
}  // namespace beltpick
