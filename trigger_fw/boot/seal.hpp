// Sealing: puts a firmware's record behind it in the flash, and finds it there again. For programs of the PC.
#pragma once

#include "boot/flash_image.hpp"
#include "boot/record.hpp"

namespace beltpick {
namespace boot {

struct Version {
  std::uint8_t major;
  std::uint8_t minor;
  std::uint8_t patch;
};

// Adds the record of the bytes below firmware_limit(). Empty when it went well, else why it cannot be.
std::string seal(FlashImage& image, const ChipLayout& chip, Version version);

// A firmware's record, and the chip it is for; `chip` is null where the image holds none.
struct Sealed {
  const ChipLayout* chip = nullptr;
  Record record;
};
Sealed find_record(const FlashImage& image);

// True when the bytes are those that were sealed.
bool is_as_sealed(const FlashImage& image, const Record& record);

// The layout of a chip by its name, its board or its signature; null when it is none of ours.
const ChipLayout* find_chip(const std::string& name);
const ChipLayout* find_chip(protocol::BoardKind board);
const ChipLayout* find_chip(const std::uint8_t (&signature)[3]);

}  // namespace boot
}  // namespace beltpick
