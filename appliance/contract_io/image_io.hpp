// Images in and out: 8- and 16-bit grey for measuring, RGB for looking at and for bit planes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/image.hpp"
#include "base/result.hpp"

namespace beltpick::contract_io {

// A grey image that owns its pixels: pixels8 or pixels16 is filled, by `bits`.
struct GreyImage {
  int rows = 0;
  int cols = 0;
  int bits = 8;              // 8 or 16
  bool from_colour = false;  // reduced from colour: worth a warning
  std::vector<std::uint8_t> pixels8;
  std::vector<std::uint16_t> pixels16;

  [[nodiscard]] ImageView<const std::uint8_t> view8() const { return {pixels8.data(), rows, cols}; }
  [[nodiscard]] ImageView<const std::uint16_t> view16() const { return {pixels16.data(), rows, cols}; }
};

using Rgb = std::array<std::uint8_t, 3>;

// The largest image that is read, in pixels.
inline constexpr std::int64_t kMaxPixels = 200'000'000;

// Reads PNG (any kind) and uncompressed BMP. Palettes are looked up; colour becomes 0.299 R + 0.587 G + 0.114 B,
// rounded; 1, 2 and 4 bits are widened to 8; transparency is dropped. Errors: kFileNotFound, kFileUnreadable,
// kFormatInvalid.
Result<GreyImage> read_grey_image(const std::filesystem::path& path);
// The same from memory; `name` stands in messages.
Result<GreyImage> decode_grey_image(std::string_view bytes, const std::string& name);

// PNG bytes, and PNG files written complete or not at all. Error: kFileNotWritten.
std::string encode_png(ImageView<const std::uint8_t> image);
std::string encode_png(ImageView<const std::uint16_t> image);
std::string encode_png(ImageView<const Rgb> image);
Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint8_t> image);
Result<void> write_png(const std::filesystem::path& path, ImageView<const std::uint16_t> image);
Result<void> write_png(const std::filesystem::path& path, ImageView<const Rgb> image);

// A BMP file of 24 bits a pixel, as projector makers' programs take it. Error: kFileNotWritten.
Result<void> write_bmp(const std::filesystem::path& path, ImageView<const Rgb> image);

}  // namespace beltpick::contract_io
