#include "flash/firmware_file.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::flash {

namespace {

constexpr std::size_t kMaxHexBytes = 4U << 20U;  // four times the text of a full flash

Result<void> seal_foreign(Firmware& firmware, const std::string& name, const std::string& mcu) {
  firmware.chip = boot::find_chip(mcu);
  if (firmware.chip == nullptr) {
    return failure(ResultCode::kUsage, "--any: expected --mcu atmega2560 or --mcu atmega328p beside it");
  }
  const std::string wrong = boot::seal(firmware.image, *firmware.chip, {0, 0, 0});
  if (!wrong.empty()) {
    return failure(ResultCode::kFirmwareUnfit, "%s: expected a program for the %s, found that %s", name.c_str(),
                   firmware.chip->name, wrong.c_str());
  }
  firmware.record = boot::find_record(firmware.image).record;
  firmware.sealed_here = true;
  return {};
}

Result<void> judge_sealed(const Firmware& firmware, const std::string& name, const std::string& mcu) {
  if (!boot::is_as_sealed(firmware.image, firmware.record)) {
    return failure(ResultCode::kChecksumWrong,
                   "%s: expected a firmware of CRC %04X, as its record says, found another; copy or build it again",
                   name.c_str(), unsigned{firmware.record.flash_crc});
  }
  if (mcu.empty() || mcu == firmware.chip->name) return {};
  return failure(ResultCode::kFirmwareUnfit,
                 "%s: expected a firmware for the %s, found one for the %s; give trigger_%s.hex", name.c_str(),
                 mcu.c_str(), firmware.chip->name, mcu.c_str());
}

}  // namespace

std::string version_text(const boot::Record& record) {
  return std::to_string(record.major) + "." + std::to_string(record.minor) + "." + std::to_string(record.patch);
}

Result<Firmware> read_firmware(const std::filesystem::path& file, const std::string& mcu, bool any) {
  const auto text = contract_io::read_file(file, kMaxHexBytes);
  if (!text) return std::unexpected(text.error());
  const std::string name = contract_io::one_line(file.string());
  Firmware firmware;
  firmware.file = file;
  const std::string wrong = boot::read_hex(*text, firmware.image);
  if (!wrong.empty()) {
    return failure(ResultCode::kFormatInvalid, "%s: %s; give the .hex of a firmware", name.c_str(), wrong.c_str());
  }
  const boot::Sealed sealed = boot::find_record(firmware.image);
  firmware.chip = sealed.chip;
  firmware.record = sealed.record;
  if (sealed.chip == nullptr && !any) {
    return failure(ResultCode::kFirmwareUnfit,
                   "%s: expected a firmware of beltpick's (trigger_atmega2560.hex, trigger_atmega328p.hex), found none "
                   "of its records; --any --mcu NAME flashes it all the same",
                   name.c_str());
  }
  const Result<void> judged =
      sealed.chip == nullptr ? seal_foreign(firmware, name, mcu) : judge_sealed(firmware, name, mcu);
  if (!judged) return std::unexpected(judged.error());
  return firmware;
}

}  // namespace beltpick::flash
