#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>

#include "contract/result_codes.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

std::string encode(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  REQUIRE(cv::imencode(".png", image, bytes));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

TEST_CASE("8- and 16-bit grey PNGs of OpenCV read back equal", "[png]") {
  cv::Mat wide(5, 9, CV_16U);
  for (int i = 0; i < 45; ++i) wide.ptr<std::uint16_t>()[i] = static_cast<std::uint16_t>(i * 1457);
  const auto image16 = decode_grey_image(encode(wide), "a.png");
  REQUIRE(image16);
  CHECK(image16->bits == 16);
  CHECK(std::equal(image16->pixels16.begin(), image16->pixels16.end(), wide.ptr<std::uint16_t>()));

  cv::Mat narrow(5, 9, CV_8U);
  for (int i = 0; i < 45; ++i) narrow.data[i] = static_cast<unsigned char>(i * 5);
  const auto image8 = decode_grey_image(encode(narrow), "a.png");
  REQUIRE(image8);
  CHECK(image8->bits == 8);
  CHECK_FALSE(image8->from_colour);
  CHECK(std::equal(image8->pixels8.begin(), image8->pixels8.end(), narrow.data));
}

TEST_CASE("OpenCV reads what is written here", "[png]") {
  const TempFolder folder;
  const GreyImage grey = ramp8(6, 11);
  REQUIRE(write_png(folder / "grey.png", grey.view8()));
  const cv::Mat back = cv::imread((folder / "grey.png").string(), cv::IMREAD_UNCHANGED);
  REQUIRE(back.type() == CV_8U);
  CHECK(std::equal(grey.pixels8.begin(), grey.pixels8.end(), back.data));

  const std::vector<std::uint16_t> wide{0, 1, 256, 65535, 4660, 513};
  REQUIRE(write_png(folder / "wide.png", ImageView<const std::uint16_t>(wide.data(), 2, 3)));
  const cv::Mat back16 = cv::imread((folder / "wide.png").string(), cv::IMREAD_UNCHANGED);
  REQUIRE(back16.type() == CV_16U);
  CHECK(std::equal(wide.begin(), wide.end(), back16.ptr<std::uint16_t>()));

  const std::vector<Rgb> colour{{255, 0, 1}, {2, 3, 4}};
  REQUIRE(write_png(folder / "colour.png", ImageView<const Rgb>(colour.data(), 1, 2)));
  const cv::Mat bgr = cv::imread((folder / "colour.png").string(), cv::IMREAD_UNCHANGED);
  REQUIRE(bgr.type() == CV_8UC3);
  CHECK(bgr.at<cv::Vec3b>(0, 0) == cv::Vec3b(1, 0, 255));
  CHECK(bgr.at<cv::Vec3b>(0, 1) == cv::Vec3b(4, 3, 2));
}

TEST_CASE("A view into a larger image is written row by row", "[png]") {
  const GreyImage grey = ramp8(4, 10);
  const ImageView<const std::uint8_t> part(grey.pixels8.data() + 2, 4, 5, 10);
  const auto image = decode_grey_image(encode_png(part), "a.png");
  REQUIRE(image);
  CHECK(image->pixels8[5] == grey.pixels8[12]);
}

TEST_CASE("Colour is reduced by the weights of the design, alpha dropped", "[png]") {
  cv::Mat bgr(1, 3, CV_8UC3);
  bgr.at<cv::Vec3b>(0, 0) = {30, 20, 10};
  bgr.at<cv::Vec3b>(0, 1) = {0, 0, 255};
  bgr.at<cv::Vec3b>(0, 2) = {77, 77, 77};
  const auto image = decode_grey_image(encode(bgr), "a.png");
  REQUIRE(image);
  CHECK(image->from_colour);
  CHECK(image->pixels8 == std::vector<std::uint8_t>{18, 76, 77});  // 0.299 * 10 + 0.587 * 20 + 0.114 * 30 = 18.15

  cv::Mat bgra(1, 1, CV_16UC4, cv::Scalar(3000, 2000, 1000, 7));
  const auto deep = decode_grey_image(encode(bgra), "a.png");
  REQUIRE(deep);
  CHECK(deep->bits == 16);
  CHECK(deep->pixels16[0] == 1815);
}

TEST_CASE("A damaged PNG is refused with its name, at every length", "[png]") {
  const GreyImage grey = ramp8(40, 30);
  const std::string good = encode_png(grey.view8());
  for (std::size_t length = 0; length < good.size(); length += 3) {
    const auto image = decode_grey_image(good.substr(0, length), "cut.png");
    REQUIRE_FALSE(image);
    CHECK(image.error().code == ResultCode::kFormatInvalid);
    CHECK(mentions(image.error(), "cut.png"));
    CHECK(is_one_line(image.error()));
  }
}

TEST_CASE("A header that promises more than the file can hold takes no memory", "[png]") {
  std::string bytes = encode_png(ramp8(2, 2).view8());
  for (const std::size_t at : {std::size_t{17}, std::size_t{21}}) bytes[at + 1] = static_cast<char>(0x3f);
  const auto image = decode_grey_image(bytes, "bomb.png");
  REQUIRE_FALSE(image);
  CHECK(is_one_line(image.error()));
}

TEST_CASE("Another format is no image", "[png]") {
  const auto text = decode_grey_image("hello", "a.txt");
  REQUIRE_FALSE(text);
  CHECK(mentions(text.error(), "PNG or BMP"));
  const auto nothing = decode_grey_image("", "empty.png");
  REQUIRE_FALSE(nothing);
  CHECK(mentions(nothing.error(), "an empty file"));
}
