// Where the emulated trigger board's two files are: the emulator's program, and the firmware that would be flashed.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "virtual_cell/world/trigger_board.hpp"

namespace beltpick::virtual_cell {

// Looks for trigger_emulator in `programs`, the folder of the running program, and unless `firmware` names an ELF file
// for trigger_atmega2560.elf there and where the build puts it, fw/bin in this build's folder or beside it; of several
// the newest. kFileNotFound tells what is missing and how to make it.
Result<TriggerBoardChoice> find_emulator(const std::filesystem::path& programs, const std::string& firmware);

}  // namespace beltpick::virtual_cell
