#include "virtual_cell/world/emulator_files.hpp"

#include <system_error>

#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEmulator = "trigger_emulator";
constexpr const char* kFirmware = "trigger_atmega2560.elf";

fs::path newest_firmware(const fs::path& programs) {
  fs::path newest;
  fs::file_time_type newest_time;
  for (const char* place : {".", "../fw/bin", "../../fw/bin"}) {
    const fs::path candidate = (programs / place / kFirmware).lexically_normal();
    std::error_code error;
    const fs::file_time_type time = fs::last_write_time(candidate, error);
    if (error || (!newest.empty() && time <= newest_time)) continue;
    newest = candidate;
    newest_time = time;
  }
  return newest;
}

}  // namespace

Result<TriggerBoardChoice> find_emulator(const fs::path& programs, const std::string& firmware) {
  std::error_code ignored;
  const fs::path emulator = programs / kEmulator;
  if (!fs::exists(emulator, ignored)) {
    return failure(ResultCode::kFileNotFound,
                   "emulated trigger board: expected %s beside this program in %s, found none; install libsimavr "
                   "(./deploy/setup firmware) and build again, or give --board host",
                   kEmulator, programs.c_str());
  }
  const fs::path elf = firmware.empty() ? newest_firmware(programs) : fs::path(firmware);
  if (elf.empty() || !fs::exists(elf, ignored)) {
    return failure(ResultCode::kFileNotFound,
                   "emulated trigger board: expected the firmware %s, found none; build it (./deploy/setup firmware; "
                   "cmake --preset fw && cmake --build --preset fw), name another by --firmware, or give --board host",
                   firmware.empty() ? kFirmware : firmware.c_str());
  }
  return TriggerBoardChoice{true, emulator, elf};
}

}  // namespace beltpick::virtual_cell
