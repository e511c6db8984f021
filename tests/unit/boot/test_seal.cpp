#include <catch2/catch.hpp>

#include "boot/seal.hpp"

using namespace beltpick::boot;
namespace protocol = beltpick::protocol;

namespace {

FlashImage program(std::uint32_t bytes) {
  FlashImage image;
  for (std::uint32_t at = 0; at < bytes; ++at) image.put(at, static_cast<std::uint8_t>(at * 31U));
  return image;
}

}  // namespace

TEST_CASE("a sealed program is found with its chip, length, version and CRC", "[seal]") {
  for (const ChipLayout& chip : kChips) {
    FlashImage image = program(1001);
    REQUIRE(seal(image, chip, {3, 4, 5}).empty());
    const Sealed sealed = find_record(image);
    REQUIRE(sealed.chip != nullptr);
    CHECK(sealed.chip->board == chip.board);
    CHECK(sealed.record.length == 1001);
    CHECK(sealed.record.major == 3);
    CHECK(sealed.record.minor == 4);
    CHECK(sealed.record.patch == 5);
    CHECK(is_as_sealed(image, sealed.record));
    CHECK(image.end() == chip.loader_start);
    image.put(500, 0);
    CHECK(!is_as_sealed(image, sealed.record));
  }
}

TEST_CASE("no record is found where a byte of it is another", "[seal]") {
  FlashImage image = program(100);
  CHECK(find_record(image).chip == nullptr);
  REQUIRE(seal(image, kChips[1], {1, 0, 0}).empty());
  for (std::uint32_t i = 0; i < kRecordBytes; ++i) {
    const std::uint32_t at = record_address(kChips[1]) + i;
    const std::uint8_t byte = image.byte(at);
    image.put(at, static_cast<std::uint8_t>(byte ^ 0x10U));
    CHECK(find_record(image).chip == nullptr);
    image.put(at, byte);
  }
  CHECK(find_record(image).chip != nullptr);
}

TEST_CASE("a program that leaves no place for its record or the loader is not sealed", "[seal]") {
  const ChipLayout& chip = kChips[1];
  FlashImage fits = program(firmware_limit(chip));
  CHECK(seal(fits, chip, {1, 0, 0}).empty());
  FlashImage reaches = program(firmware_limit(chip) + 1);
  CHECK(!seal(reaches, chip, {1, 0, 0}).empty());
  FlashImage with_loader = program(10);
  with_loader.put(chip.loader_start, 0);
  CHECK(!seal(with_loader, chip, {1, 0, 0}).empty());
  FlashImage nothing;
  CHECK(!seal(nothing, chip, {1, 0, 0}).empty());
}

TEST_CASE("chips are found by name, board and signature", "[seal]") {
  for (const ChipLayout& chip : kChips) {
    const std::uint8_t signature[] = {chip.signature[0], chip.signature[1], chip.signature[2]};
    for (const ChipLayout* found : {find_chip(std::string(chip.name)), find_chip(chip.board), find_chip(signature)}) {
      REQUIRE(found != nullptr);
      CHECK(found->name == std::string(chip.name));
    }
  }
  CHECK(find_chip(std::string("atmega32")) == nullptr);
  CHECK(find_chip(protocol::BoardKind::kHost) == nullptr);
  CHECK(find_chip({0x1E, 0x98, 0x02}) == nullptr);
}

// The loader erases and writes whole pages: record and loader must not share one with the firmware, nor with each
// other.
TEST_CASE("record and loader begin on pages of their own, in the largest boot section", "[seal]") {
  for (const ChipLayout& chip : kChips) {
    CHECK(chip.loader_start % chip.page_bytes == 0);
    CHECK(firmware_limit(chip) % chip.page_bytes == 0);
    CHECK(record_address(chip) >= firmware_limit(chip));
    CHECK(chip.flash_bytes - chip.loader_start == (chip.page_bytes == 256 ? 8192 : 2048));
    CHECK((chip.high_fuse & 0x07U) == 0);  // BOOTSZ 00, BOOTRST programmed
    CHECK((chip.lock & 0x10U) == 0);       // BLB11: no SPM into the loader's section
  }
}
