#include "chip_of_files.hpp"

#include <elf.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "boot/seal.hpp"

namespace emulator {

namespace {

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

beltpick::boot::FlashImage read_flash(const std::vector<std::string>& paths) {
  beltpick::boot::FlashImage flash;
  for (const std::string& path : paths) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error(path + ": cannot be opened");
    const std::string wrong = beltpick::boot::read_hex({std::istreambuf_iterator<char>(file), {}}, flash);
    if (!wrong.empty()) throw std::runtime_error(path + ": " + wrong);
  }
  return flash;
}

Mcu mcu_of_flash(const beltpick::boot::FlashImage& flash) {
  const beltpick::boot::ChipLayout* chip = beltpick::boot::find_record(flash).chip;
  for (const beltpick::boot::ChipLayout& layout : beltpick::boot::kChips) {
    if (chip == nullptr && flash.has(layout.loader_start)) chip = &layout;
  }
  if (chip == nullptr)
    throw std::runtime_error("--flash: expected a firmware of ours, or a boot loader, found neither");
  return chip->board == beltpick::protocol::BoardKind::kAtmega2560 ? Mcu::kAtmega2560 : Mcu::kAtmega328p;
}

}  // namespace

std::unique_ptr<Chip> make_chip(const std::string& elf, const std::vector<std::string>& flash) {
  if (!elf.empty()) return std::make_unique<Chip>(mcu_of_elf(elf), elf);
  const beltpick::boot::FlashImage image = read_flash(flash);
  return std::make_unique<Chip>(mcu_of_flash(image), image);
}

}  // namespace emulator
