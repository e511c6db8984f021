#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>

#include "contract/result_codes.hpp"
#include "samples.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

std::string grey_palette(int entries) {
  std::string palette;
  for (int i = 0; i < entries; ++i) palette += little(static_cast<std::uint64_t>(i) * 0x010101U, 4);
  return palette;
}

}  // namespace

TEST_CASE("BMP rows run bottom-up unless the height is negative", "[bmp]") {
  const std::string pixels = {1, 2, 3, 0, 4, 5, 6, 0};  // two rows of three, padded to four bytes
  const auto bottom_up = decode_grey_image(bmp(3, 2, 8, grey_palette(256), pixels), "a.bmp");
  REQUIRE(bottom_up);
  CHECK(bottom_up->pixels8 == std::vector<std::uint8_t>{4, 5, 6, 1, 2, 3});
  const auto top_down = decode_grey_image(bmp(3, -2, 8, grey_palette(256), pixels), "a.bmp");
  REQUIRE(top_down);
  CHECK(top_down->pixels8 == std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6});
  CHECK(top_down->rows == 2);
  CHECK(top_down->cols == 3);
  CHECK_FALSE(top_down->from_colour);
}

TEST_CASE("A paletted BMP is read through its palette", "[bmp]") {
  std::string palette = little(0x102030, 4) + little(0x0a0a0a, 4);  // blue first in the file: R 0x10, G 0x20, B 0x30
  palette.resize(1024);
  const auto image = decode_grey_image(bmp(2, 1, 8, palette, std::string("\x00\x01\x00\x00", 4)), "a.bmp");
  REQUIRE(image);
  CHECK(image->from_colour);
  CHECK(image->pixels8[0] == 29);  // 0.299 * 16 + 0.587 * 32 + 0.114 * 48 = 29.04
  CHECK(image->pixels8[1] == 10);
}

TEST_CASE("BMPs of 1, 4, 16, 24 and 32 bits are read", "[bmp]") {
  const auto one =
      decode_grey_image(bmp(3, 1, 1, little(0, 4) + little(0xffffff, 4), std::string("\xa0\0\0\0", 4)), "a.bmp");
  REQUIRE(one);
  CHECK(one->pixels8 == std::vector<std::uint8_t>{255, 0, 255});
  const auto four = decode_grey_image(bmp(3, 1, 4, grey_palette(16), std::string("\x1f\x20\0\0", 4)), "a.bmp");
  REQUIRE(four);
  CHECK(four->pixels8 == std::vector<std::uint8_t>{1, 15, 2});
  const auto sixteen = decode_grey_image(bmp(2, 1, 16, "", little(0x7fff, 2) + little(0, 2)), "a.bmp");
  REQUIRE(sixteen);
  CHECK(sixteen->pixels8 == std::vector<std::uint8_t>{255, 0});
  const auto full = decode_grey_image(bmp(1, 1, 24, "", little(0xff0000, 4)), "a.bmp");
  REQUIRE(full);
  CHECK(full->pixels8[0] == 76);  // 0.299 * 255
  CHECK(full->from_colour);
  const std::string masks = little(0xff, 4) + little(0xff00, 4) + little(0xff0000, 4);
  const auto masked = decode_grey_image(bmp(1, 1, 32, masks, little(0xff, 4), 3), "a.bmp");
  REQUIRE(masked);
  CHECK(masked->pixels8[0] == 76);
}

TEST_CASE("What OpenCV writes as BMP reads back equal", "[bmp]") {
  cv::Mat grey(7, 13, CV_8U);
  for (int i = 0; i < 7 * 13; ++i) grey.data[i] = static_cast<unsigned char>(i * 3);
  std::vector<unsigned char> bytes;
  REQUIRE(cv::imencode(".bmp", grey, bytes));
  const auto image = decode_grey_image({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "a.bmp");
  REQUIRE(image);
  CHECK(std::equal(image->pixels8.begin(), image->pixels8.end(), grey.data));
}

TEST_CASE("Compressed, absurd and truncated BMPs are refused by name", "[bmp]") {
  const std::string good = bmp(3, 2, 8, grey_palette(256), std::string(8, 'x'));
  for (std::size_t length = 2; length < good.size(); length += 11) {
    const auto image = decode_grey_image(good.substr(0, length), "cut.bmp");
    REQUIRE_FALSE(image);
    CHECK(mentions(image.error(), "cut.bmp"));
  }
  const auto compressed = decode_grey_image(bmp(3, 2, 8, grey_palette(256), "xxxxxxxx", 1), "rle.bmp");
  REQUIRE_FALSE(compressed);
  CHECK(mentions(compressed.error(), "compression"));
  const auto huge = decode_grey_image(bmp(2000000000, 2000000000, 24, "", "xx"), "huge.bmp");
  REQUIRE_FALSE(huge);
  const auto lowest = decode_grey_image(bmp(1, static_cast<int>(0x80000000U), 8, grey_palette(256), "xx"), "low.bmp");
  REQUIRE_FALSE(lowest);
}
