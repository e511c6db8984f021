// The microcontroller's own flash: read, and written a page at a time below the loader.
#pragma once

#include <avr/boot.h>
#include <avr/pgmspace.h>

#include "boot/record.hpp"

namespace beltpick {
namespace boot {

#if defined(__AVR_ATmega2560__)
constexpr ChipLayout kChip = kChips[0];
#elif defined(__AVR_ATmega328P__)
constexpr ChipLayout kChip = kChips[1];
#endif
static_assert(kChip.signature[0] == SIGNATURE_0 && kChip.signature[1] == SIGNATURE_1 &&
                  kChip.signature[2] == SIGNATURE_2 && kChip.page_bytes == SPM_PAGESIZE &&
                  kChip.flash_bytes == FLASHEND + 1UL,
              "the layout is that of another chip");

#if FLASHEND > 0xFFFF
using FlashAddress = uint32_t;
inline FlashAddress byte_address(uint8_t extended, uint16_t word) {
  return (static_cast<FlashAddress>(extended) << 16U | word) << 1U;
}
// avr-libc's own finds no registers under clang.
inline uint8_t read_flash(FlashAddress at) {
  uint8_t byte;
  RAMPZ = static_cast<uint8_t>(at >> 16U);
  __asm__ volatile("elpm %0, Z" : "=r"(byte) : "z"(static_cast<uint16_t>(at)));
  return byte;
}
#else
using FlashAddress = uint16_t;
inline FlashAddress byte_address(uint8_t, uint16_t word) { return static_cast<FlashAddress>(word << 1U); }
inline uint8_t read_flash(FlashAddress at) { return pgm_read_byte(at); }
#endif
constexpr FlashAddress kLoaderStart = static_cast<FlashAddress>(kChip.loader_start);
constexpr FlashAddress kFirmwareLimit = static_cast<FlashAddress>(firmware_limit(kChip));

inline void erase_page(FlashAddress at) {
  boot_page_erase(at);
  boot_spm_busy_wait();
  boot_rww_enable();
}

inline void write_page(FlashAddress at, const uint8_t* bytes) {
  erase_page(at);
  for (uint16_t i = 0; i < kChip.page_bytes; i = static_cast<uint16_t>(i + 2)) {
    boot_page_fill(at + i, static_cast<uint16_t>(bytes[i] | bytes[i + 1] << 8U));
  }
  boot_page_write(at);
  boot_spm_busy_wait();
  boot_rww_enable();
}

// The record is there, and the firmware is what it says. Here the record lies in memory as on the wire.
inline bool firmware_is_whole() {
  struct {
    Record record;
    uint16_t crc;
  } stored;
  static_assert(sizeof stored == kRecordBytes, "the compiler pads nothing here");
  uint8_t* bytes = reinterpret_cast<uint8_t*>(&stored);
  uint16_t crc = protocol::kCrcStart;
  for (uint8_t i = 0; i < kRecordBytes; ++i) {
    bytes[i] = read_flash(static_cast<FlashAddress>(kLoaderStart - kRecordBytes + i));
    if (i < kRecordBytes - protocol::kCrcBytes) crc = protocol::crc16_step(crc, bytes[i]);
  }
  const Record& record = stored.record;
  if (crc != stored.crc || record.magic != kRecordMagic || record.board != kChip.board ||
      record.length > kFirmwareLimit) {
    return false;
  }
  crc = protocol::kCrcStart;
  for (FlashAddress at = 0; at < static_cast<FlashAddress>(record.length); ++at) {
    crc = protocol::crc16_step(crc, read_flash(at));
  }
  return crc == record.flash_crc;
}

}  // namespace boot
}  // namespace beltpick
