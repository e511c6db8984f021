// The .hex files of a board, as the build makes them: boot loader, firmware, and the same firmware as an older version.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "boot/seal.hpp"
#include "emulator/chip.hpp"
#include "support/temp_folder.hpp"

namespace emulator {

namespace boot = beltpick::boot;
namespace protocol = beltpick::protocol;

inline const boot::ChipLayout& layout(Mcu mcu) {
  return *boot::find_chip(std::string(mcu == Mcu::kAtmega2560 ? "atmega2560" : "atmega328p"));
}

// `kind`: boot, trigger or older.
inline std::string hex_file(const std::string& kind, Mcu mcu) {
  return BELTPICK_FIRMWARE_DIR "/" + kind + "_" + layout(mcu).name + ".hex";
}

inline boot::FlashImage image_of(const std::vector<std::string>& kinds, Mcu mcu) {
  boot::FlashImage image;
  for (const std::string& kind : kinds) {
    const std::string text = beltpick::test::file_bytes(hex_file(kind, mcu));
    const std::string wrong = boot::read_hex(text, image);
    if (!wrong.empty()) throw std::runtime_error(hex_file(kind, mcu) + ": " + wrong);
  }
  return image;
}

}  // namespace emulator
