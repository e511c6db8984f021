// Where loader, firmware and the firmware's record lie in the flash of each microcontroller. The loader's place is the
// largest boot section of the chip, which the fuses name: a board that came with another loader keeps its fuses.
#pragma once

#include <stdint.h>

#include "protocol/messages.hpp"

namespace beltpick {
namespace boot {

struct ChipLayout {
  protocol::BoardKind board;
  const char* name;  // as avr-gcc and avrdude know it
  uint8_t signature[3];
  uint32_t flash_bytes;
  uint16_t page_bytes;
  uint32_t loader_start;  // the loader has the flash from here on
  // What an in-system programmer sets: the crystal, reset into the loader's section, brown-out below 4.3 V.
  uint8_t low_fuse;
  uint8_t high_fuse;
  uint8_t extended_fuse;
  uint8_t lock;  // the loader's section cannot be written by SPM
};

constexpr uint8_t kChipCount = 2;
constexpr ChipLayout kChips[kChipCount] = {
    {protocol::BoardKind::kAtmega2560, "atmega2560", {0x1E, 0x98, 0x01}, 0x40000, 256, 0x3E000, 0xFF, 0xD8, 0xFC, 0xEF},
    {protocol::BoardKind::kAtmega328p, "atmega328p", {0x1E, 0x95, 0x0F}, 0x8000, 128, 0x7800, 0xFF, 0xD8, 0xFC, 0xEF},
};

// The record's bytes end where the loader begins: in a page of their own, which is written last.
constexpr uint8_t kRecordBytes = 16;
constexpr uint32_t record_address(const ChipLayout& chip) { return chip.loader_start - kRecordBytes; }
// The firmware ends before that page.
constexpr uint32_t firmware_limit(const ChipLayout& chip) { return chip.loader_start - chip.page_bytes; }

}  // namespace boot
}  // namespace beltpick
