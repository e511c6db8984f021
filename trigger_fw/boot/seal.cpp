#include "boot/seal.hpp"

#include <algorithm>

namespace beltpick {
namespace boot {

namespace {

std::uint16_t crc_of(const FlashImage& image, std::uint32_t length) {
  std::uint16_t crc = protocol::kCrcStart;
  for (std::uint32_t at = 0; at < length; ++at) crc = protocol::crc16_step(crc, image.byte(at));
  return crc;
}

template <class Predicate>
const ChipLayout* first_chip(Predicate fits) {
  const auto found = std::find_if(std::begin(kChips), std::end(kChips), fits);
  return found != std::end(kChips) ? found : nullptr;
}

}  // namespace

std::string seal(FlashImage& image, const ChipLayout& chip, Version version) {
  Record record;
  record.board = chip.board;
  record.major = version.major;
  record.minor = version.minor;
  record.patch = version.patch;
  record.length = image.end(firmware_limit(chip));
  record.flash_crc = crc_of(image, record.length);
  if (record.length == 0) return "there is nothing below the boot loader's place";
  if (image.end() > firmware_limit(chip))
    return "it does not leave the boot loader and the firmware's record their place";
  std::uint8_t bytes[kRecordBytes];
  encode_record(record, bytes);
  for (std::uint32_t i = 0; i < kRecordBytes; ++i) image.put(record_address(chip) + i, bytes[i]);
  return "";
}

Sealed find_record(const FlashImage& image) {
  for (const ChipLayout& chip : kChips) {
    std::uint8_t bytes[kRecordBytes];
    for (std::uint32_t i = 0; i < kRecordBytes; ++i) bytes[i] = image.byte(record_address(chip) + i);
    Sealed sealed;
    if (decode_record(bytes, sealed.record) && sealed.record.board == chip.board) {
      sealed.chip = &chip;
      return sealed;
    }
  }
  return {};
}

bool is_as_sealed(const FlashImage& image, const Record& record) {
  return record.length <= FlashImage::kCapacity && crc_of(image, record.length) == record.flash_crc;
}

const ChipLayout* find_chip(const std::string& name) {
  return first_chip([&](const ChipLayout& chip) { return name == chip.name; });
}

const ChipLayout* find_chip(protocol::BoardKind board) {
  return first_chip([&](const ChipLayout& chip) { return board == chip.board; });
}

const ChipLayout* find_chip(const std::uint8_t (&signature)[3]) {
  return first_chip([&](const ChipLayout& chip) {
    return std::equal(std::begin(signature), std::end(signature), std::begin(chip.signature));
  });
}

}  // namespace boot
}  // namespace beltpick
