// Which of the boards' microcontrollers an ELF file was linked for.
#pragma once

#include <string>

#include "emulator/chip.hpp"

namespace emulator {

// By the file's own flags: avr6 is the ATmega2560's, avr5 the ATmega328P's. Throws std::runtime_error that tells what
// is wrong with the file.
Mcu mcu_of_elf(const std::string& path);

}  // namespace emulator
