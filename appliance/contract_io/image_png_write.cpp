// PNG bytes from images, by way of libpng.
#include <png.h>

#include <bit>
#include <stdexcept>

#include "contract_io/image_io.hpp"

namespace beltpick::contract_io {
namespace {

struct PngWriting {
  std::string bytes;
  png_structp png = nullptr;
  png_infop info = nullptr;

  PngWriting() = default;
  PngWriting(const PngWriting&) = delete;
  PngWriting& operator=(const PngWriting&) = delete;
  ~PngWriting() { png_destroy_write_struct(&png, &info); }
};

void append_bytes(png_structp png, png_bytep data, std::size_t count) {
  static_cast<PngWriting*>(png_get_io_ptr(png))->bytes.append(reinterpret_cast<const char*>(data), count);
}

// Writes rows of `row_bytes` that stand `stride_bytes` apart. False where libpng gives up.
bool write_rows(PngWriting& writing, const std::uint8_t* first, std::ptrdiff_t stride_bytes, png_uint_32 cols,
                png_uint_32 rows, int bits, int colour_type) {
  writing.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  if (writing.png == nullptr) return false;
  if (setjmp(png_jmpbuf(writing.png)) != 0) return false;
  writing.info = png_create_info_struct(writing.png);
  png_set_write_fn(writing.png, &writing, append_bytes, nullptr);
  png_set_compression_level(writing.png, 1);  // a third of the time of the default for a few percent of size
  png_set_IHDR(writing.png, writing.info, cols, rows, bits, colour_type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(writing.png, writing.info);
  if constexpr (std::endian::native == std::endian::little) png_set_swap(writing.png);
  for (png_uint_32 r = 0; r < rows; ++r) png_write_row(writing.png, first + r * stride_bytes);
  png_write_end(writing.png, nullptr);
  return true;
}

template <class T>
std::string encode(ImageView<const T> image, int bits, int colour_type) {
  PngWriting writing;
  const auto* first = reinterpret_cast<const std::uint8_t*>(image.data);
  if (!write_rows(writing, first, image.stride * static_cast<std::ptrdiff_t>(sizeof(T)),
                  static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows), bits, colour_type)) {
    throw std::logic_error("an image that PNG cannot hold");
  }
  return std::move(writing.bytes);
}

}  // namespace

std::string encode_png(ImageView<const std::uint8_t> image) { return encode(image, 8, PNG_COLOR_TYPE_GRAY); }
std::string encode_png(ImageView<const std::uint16_t> image) { return encode(image, 16, PNG_COLOR_TYPE_GRAY); }
std::string encode_png(ImageView<const Rgb> image) { return encode(image, 8, PNG_COLOR_TYPE_RGB); }

}  // namespace beltpick::contract_io
