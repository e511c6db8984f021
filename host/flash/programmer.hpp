// The three ways into the microcontroller, and the avrdude command of each.
#pragma once

#include <string>
#include <vector>

#include "boot/layout.hpp"

namespace beltpick::flash {

enum class Way {
  kOurLoader,    // over the serial line, by the boot loader of trigger_fw/boot: what the field uses
  kBoardLoader,  // over the serial line, by the loader that an Arduino board came with
  kInSystem,     // by an in-system programmer on the board's SPI pins: fuses, boot loader and firmware
};

struct AvrdudeJob {
  Way way = Way::kOurLoader;
  const boot::ChipLayout* chip = nullptr;
  std::string firmware;  // .hex
  std::string port;      // the trigger box's tty; not of kInSystem
  // Of kInSystem: avrdude's name of the programmer, where it is (empty: on USB), and the boot loader's .hex.
  std::string programmer;
  std::string programmer_port;
  std::string loader;
};

// The command line, the program's name first.
std::vector<std::string> avrdude_command(const AvrdudeJob& job);

// The command line as a shell takes it.
std::string shell_text(const std::vector<std::string>& command);

}  // namespace beltpick::flash
