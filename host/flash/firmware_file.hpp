// A firmware's .hex file: which board it is for, what its record says, and whether it is whole.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "boot/seal.hpp"

namespace beltpick::flash {

struct Firmware {
  std::filesystem::path file;
  const boot::ChipLayout* chip = nullptr;
  boot::Record record;
  boot::FlashImage image;
  bool sealed_here = false;  // a program of somebody else's: the record was added, so that the boot loader starts it
};

// "0.1.0"
std::string version_text(const boot::Record& record);

// Reads and judges `file`. `mcu`: the chip it must be for, or empty. `any`: also takes what is no firmware of ours;
// `mcu` must then name the chip. Errors: those of reading; kFormatInvalid, kChecksumWrong, kFirmwareUnfit, kUsage.
Result<Firmware> read_firmware(const std::filesystem::path& file, const std::string& mcu, bool any);

}  // namespace beltpick::flash
