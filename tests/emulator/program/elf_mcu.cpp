#include "elf_mcu.hpp"

#include <elf.h>

#include <cstring>
#include <fstream>
#include <stdexcept>

namespace emulator {

Mcu mcu_of_elf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw std::runtime_error(path +
                             ": cannot be opened; build the firmware: cmake --preset fw && cmake --build --preset fw");
  Elf32_Ehdr header{};
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  const bool whole = file.gcount() == static_cast<std::streamsize>(sizeof header);
  if (!whole || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_machine != EM_AVR) {
    throw std::runtime_error(path + ": expected an ELF file for AVR, found something else; give the firmware's .elf");
  }
  constexpr Elf32_Word kMachine = 0x7F;
  const Elf32_Word machine = header.e_flags & kMachine;
  if (machine == 6) return Mcu::kAtmega2560;
  if (machine == 5) return Mcu::kAtmega328p;
  throw std::runtime_error(path +
                           ": expected a program for the ATmega2560 or the ATmega328P, found one for AVR family " +
                           std::to_string(machine));
}

}  // namespace emulator
