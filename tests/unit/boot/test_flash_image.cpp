#include <catch2/catch.hpp>

#include "boot/flash_image.hpp"

using namespace beltpick::boot;

namespace {

std::string wrong_with(const std::string& text) {
  FlashImage image;
  return read_hex(text, image);
}

constexpr const char* kEnd = ":00000001FF\n";

}  // namespace

// The example of Intel's specification of the format, page "data record".
TEST_CASE("a line of Intel HEX is bytes at an address", "[hex]") {
  FlashImage image;
  REQUIRE(read_hex(":10010000214601360121470136007EFE09D2190140\n" + std::string(kEnd), image).empty());
  CHECK(image.byte(0x100) == 0x21);
  CHECK(image.byte(0x10F) == 0x01);
  CHECK(!image.has(0xFF));
  CHECK(image.byte(0xFF) == 0xFF);
  CHECK(image.end() == 0x110);
  CHECK(image.end(0x108) == 0x108);
  CHECK(image.end(0x80) == 0);
}

TEST_CASE("what is written as text is read back the same, beyond 64 KB and with holes", "[hex]") {
  FlashImage image;
  for (const std::uint32_t at : {0U, 1U, 15U, 16U, 200U, 0xFFFFU, 0x10000U, 0x3DFF0U, 0x3FFFFU}) {
    image.put(at, static_cast<std::uint8_t>(at * 7U + 1U));
  }
  FlashImage again;
  REQUIRE(read_hex(hex_text(image), again).empty());
  for (std::uint32_t at = 0; at < FlashImage::kCapacity; ++at) {
    if (image.has(at) != again.has(at) || image.byte(at) != again.byte(at)) FAIL("differs at " << at);
  }
}

TEST_CASE("segment addresses, other line ends and what tools add are taken", "[hex]") {
  FlashImage image;
  const std::string text = "\r\n:020000021000EC\r\n:0100040055A6 \r\n:0400000300003E00BB\r\n" + std::string(kEnd);
  REQUIRE(read_hex(text, image).empty());
  CHECK(image.byte(0x10004) == 0x55);
}

TEST_CASE("a damaged file is refused with the line", "[hex]") {
  CHECK(wrong_with(":10010000214601360121470136007EFE09D2190141\n").find("line 1: its checksum") == 0);
  CHECK(wrong_with("\x7F"
                   "ELF")
            .find("line 1: expected a line of Intel HEX") == 0);
  CHECK(wrong_with(":0100\n").find("line 1: expected a line") == 0);
  CHECK(wrong_with(":03010000214601\n").find("line 1: expected a line") == 0);
  CHECK(wrong_with(":0101000021ZZ\n").find("line 1: expected a line") == 0);
  CHECK(wrong_with(":0000000AF6\n").find("record type") != std::string::npos);
  CHECK(wrong_with(":020000041000EA\n:0100000055AA\n").find("line 2: its address is beyond") == 0);
  CHECK(wrong_with(":0100000055AA\n").find("not whole") != std::string::npos);
  CHECK(wrong_with("").find("not whole") != std::string::npos);
}
