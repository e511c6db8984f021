// The chip that runs the files of a firmware: which of the boards' microcontrollers it is, they tell themselves.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emulator/chip.hpp"

namespace emulator {

// From `elf`, by the file's own flags: avr6 is the ATmega2560's, avr5 the ATmega328P's. Where that is empty, from the
// Intel HEX files of `flash`, by the place of the boot loader or the firmware's record. Throws std::runtime_error that
// tells what is wrong with a file.
std::unique_ptr<Chip> make_chip(const std::string& elf, const std::vector<std::string>& flash);

}  // namespace emulator
