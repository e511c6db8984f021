// Uncompressed BMP of 24 bits a pixel, bottom-up. Source: Microsoft's BITMAPFILEHEADER and BITMAPINFOHEADER.
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"

namespace beltpick::contract_io {

namespace {

constexpr std::uint32_t kFileHeaderBytes = 14;
constexpr std::uint32_t kInfoHeaderBytes = 40;

void append_u32(std::string& bytes, std::uint32_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift);
}

void append_u16(std::string& bytes, std::uint32_t value) {
  bytes += static_cast<char>(value);
  bytes += static_cast<char>(value >> 8U);
}

std::string headers(std::uint32_t cols, std::uint32_t rows, std::uint32_t pixel_bytes) {
  std::string bytes = "BM";
  append_u32(bytes, kFileHeaderBytes + kInfoHeaderBytes + pixel_bytes);
  append_u32(bytes, 0);
  append_u32(bytes, kFileHeaderBytes + kInfoHeaderBytes);
  append_u32(bytes, kInfoHeaderBytes);
  append_u32(bytes, cols);
  append_u32(bytes, rows);
  append_u16(bytes, 1);   // planes in the sense of BMP
  append_u16(bytes, 24);  // bits a pixel
  append_u32(bytes, 0);   // not compressed
  append_u32(bytes, pixel_bytes);
  for (int i = 0; i < 4; ++i) append_u32(bytes, 0);  // resolution and palette: none
  return bytes;
}

}  // namespace

Result<void> write_bmp(const std::filesystem::path& path, ImageView<const Rgb> image) {
  const std::size_t row_bytes = (static_cast<std::size_t>(image.cols) * 3 + 3) / 4 * 4;
  std::string bytes = headers(static_cast<std::uint32_t>(image.cols), static_cast<std::uint32_t>(image.rows),
                              static_cast<std::uint32_t>(row_bytes * static_cast<std::size_t>(image.rows)));
  for (int row = image.rows - 1; row >= 0; --row) {
    const std::size_t end = bytes.size() + row_bytes;
    for (int col = 0; col < image.cols; ++col) {
      const Rgb& pixel = image(row, col);
      for (const std::size_t channel : {2U, 1U, 0U}) bytes += static_cast<char>(pixel[channel]);
    }
    bytes.resize(end, '\0');
  }
  return write_file(path, bytes);
}

}  // namespace beltpick::contract_io
