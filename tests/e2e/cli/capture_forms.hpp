// One capture in every form that the design allows.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "support/capture_files.hpp"

namespace beltpick::test {

using Encode = std::function<std::string(const contract_io::GreyImage&)>;

// A paletted BMP whose palette runs backwards: entry i is grey 255 - i.
inline std::string backwards_bmp(const contract_io::GreyImage& image) {
  std::string palette;
  for (std::uint64_t i = 0; i < 256; ++i) palette += little((255 - i) * 0x010101U, 4);
  std::string pixels;
  for (int row = image.rows - 1; row >= 0; --row) {
    for (int col = 0; col < image.cols; ++col) pixels += static_cast<char>(255 - image.view8()(row, col));
    pixels.append(static_cast<std::size_t>(-image.cols & 3), '\0');
  }
  return bmp(image.cols, image.rows, 8, palette, pixels);
}

inline std::string deep_png(const contract_io::GreyImage& image) {
  std::vector<std::uint16_t> deep;
  for (const std::uint8_t level : image.pixels8) deep.push_back(static_cast<std::uint16_t>(level * 257));
  return contract_io::encode_png(ImageView<const std::uint16_t>(deep.data(), image.rows, image.cols));
}

inline std::string colour_png(const contract_io::GreyImage& image) {
  std::vector<contract_io::Rgb> colour;
  for (const std::uint8_t level : image.pixels8) colour.push_back({level, level, level});
  return contract_io::encode_png(ImageView<const contract_io::Rgb>(colour.data(), image.rows, image.cols));
}

// Writes the capture `from` to the folder `to`, its images encoded anew for a camera that saturates at `full_scale`.
inline bool convert(const std::filesystem::path& from, const std::filesystem::path& to, int full_scale,
                    const Encode& encode) {
  contract_io::Warnings warnings;
  auto reader = contract_io::CaptureReader::open(from, warnings);
  if (!reader || !contract_io::make_folder(to)) return false;
  CaptureHeader header = reader->header();
  header.full_scale = full_scale;
  for (int i = 0; i < reader->frames(); ++i) {
    const auto image = reader->image(i, warnings);
    const std::string& file = header.sequence.frames[static_cast<std::size_t>(i)].file;
    if (!image || !contract_io::write_file(to / file, encode(*image))) return false;
  }
  return contract_io::write_capture(to / "capture.json", header).has_value();
}

}  // namespace beltpick::test
