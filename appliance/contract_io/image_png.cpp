// PNG by way of libpng. Its errors come by longjmp: functions that call it hold nothing that needs destroying.
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>

#include "contract/result_codes.hpp"
#include "contract_io/image_formats.hpp"

namespace beltpick::contract_io {
namespace {

constexpr std::size_t kSignatureBytes = 8;
constexpr png_uint_32 kMaxSide = 65535;
constexpr std::uint64_t kMaxDeflateRatio = 1040;  // zlib packs at most about 1032 bytes into one

struct PngReading {
  std::string_view bytes;
  std::size_t at = 0;
  png_structp png = nullptr;
  png_infop info = nullptr;
  char message[96]{};
  png_uint_32 width = 0, height = 0;
  int bits = 0, channels = 0;
  int file_colour_type = 0;  // before palettes are looked up
  std::size_t row_bytes = 0;

  PngReading() = default;
  PngReading(const PngReading&) = delete;
  PngReading& operator=(const PngReading&) = delete;
  ~PngReading() { png_destroy_read_struct(&png, &info, nullptr); }
};

void keep_message(png_structp png, png_const_charp message) {
  auto* reading = static_cast<PngReading*>(png_get_error_ptr(png));
  std::snprintf(reading->message, sizeof reading->message, "%s", message);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp /*png*/, png_const_charp /*message*/) {}

void take_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto* reading = static_cast<PngReading*>(png_get_io_ptr(png));
  if (count > reading->bytes.size() - reading->at) png_error(png, "the file ends too early");
  std::memcpy(out, reading->bytes.data() + reading->at, count);
  reading->at += count;
}

// Asks for whole bytes a channel, palettes looked up, no transparency; 16 bits in this machine's byte order.
void set_transformations(PngReading& reading) {
  png_set_expand(reading.png);
  png_set_strip_alpha(reading.png);
  if constexpr (std::endian::native == std::endian::little) png_set_swap(reading.png);
  png_set_interlace_handling(reading.png);
  png_read_update_info(reading.png, reading.info);
}

bool read_header(PngReading& reading) {
  reading.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reading, keep_message, ignore_warning);
  if (reading.png == nullptr) return false;
  if (setjmp(png_jmpbuf(reading.png)) != 0) return false;
  reading.info = png_create_info_struct(reading.png);
  png_set_read_fn(reading.png, &reading, take_bytes);
  png_set_user_limits(reading.png, kMaxSide, kMaxSide);
  png_read_info(reading.png, reading.info);
  reading.width = png_get_image_width(reading.png, reading.info);
  reading.height = png_get_image_height(reading.png, reading.info);
  reading.file_colour_type = png_get_color_type(reading.png, reading.info);
  set_transformations(reading);
  reading.bits = png_get_bit_depth(reading.png, reading.info);
  reading.channels = png_get_channels(reading.png, reading.info);
  reading.row_bytes = png_get_rowbytes(reading.png, reading.info);
  return true;
}

bool read_rows(PngReading& reading, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reading.png)) != 0) return false;
  png_read_image(reading.png, rows);
  png_read_end(reading.png, nullptr);
  return true;
}

template <class T>
void reduce(const PngReading& reading, const std::vector<std::uint8_t>& raw, std::vector<T>& grey) {
  const std::size_t pixels = std::size_t{reading.width} * reading.height;
  grey.resize(pixels);
  if (reading.channels == 1) {
    std::memcpy(grey.data(), raw.data(), pixels * sizeof(T));
    return;
  }
  for (std::size_t i = 0; i < pixels; ++i) {
    T rgb[3];
    std::memcpy(rgb, raw.data() + i * sizeof rgb, sizeof rgb);
    grey[i] = static_cast<T>(grey_from_rgb(rgb[0], rgb[1], rgb[2]));
  }
}

// A palette of greys alone is a grey image; RGB is colour even where its channels are equal.
bool has_colour(const PngReading& reading, const std::vector<std::uint8_t>& raw) {
  if (reading.file_colour_type != PNG_COLOR_TYPE_PALETTE) return reading.channels == 3;
  for (std::size_t i = 0; i + 2 < raw.size(); i += 3) {
    if (raw[i] != raw[i + 1] || raw[i] != raw[i + 2]) return true;
  }
  return false;
}

std::unexpected<Error> broken(const PngReading& reading, const std::string& name) {
  return failure(ResultCode::kFormatInvalid,
                 "%s: expected a whole PNG image, found a damaged one (%s); copy or make it again", name.c_str(),
                 reading.message[0] != '\0' ? reading.message : "not readable");
}

// Images wider or higher than their bytes can possibly hold are refused before memory is taken for them.
Result<void> check_size(const PngReading& reading, const std::string& name) {
  const std::uint64_t pixels = std::uint64_t{reading.width} * reading.height;
  if (pixels > static_cast<std::uint64_t>(kMaxPixels)) {
    return failure(ResultCode::kLimitExceeded, "%s: expected at most %lld pixels, found %u x %u; use a smaller image",
                   name.c_str(), static_cast<long long>(kMaxPixels), reading.width, reading.height);
  }
  if (pixels / 8 > kMaxDeflateRatio * reading.bytes.size()) {
    return failure(
        ResultCode::kFormatInvalid,
        "%s: expected a whole PNG image, found %zu bytes for %u x %u pixels; the file is cut off: copy it again",
        name.c_str(), reading.bytes.size(), reading.width, reading.height);
  }
  return {};
}

}  // namespace

bool looks_like_png(std::string_view bytes) {
  return bytes.size() >= kSignatureBytes &&
         png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, kSignatureBytes) == 0;
}

Result<GreyImage> decode_png(std::string_view bytes, const std::string& name) {
  PngReading reading;
  reading.bytes = bytes;
  if (!read_header(reading)) return broken(reading, name);
  if (const auto sized = check_size(reading, name); !sized) return std::unexpected(sized.error());
  std::vector<std::uint8_t> raw(reading.row_bytes * reading.height);
  std::vector<png_bytep> rows(reading.height);
  for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = raw.data() + r * reading.row_bytes;
  if (!read_rows(reading, rows.data())) return broken(reading, name);

  GreyImage image;
  image.rows = static_cast<int>(reading.height);
  image.cols = static_cast<int>(reading.width);
  image.bits = reading.bits;
  image.from_colour = has_colour(reading, raw);
  if (reading.bits == 16) {
    reduce(reading, raw, image.pixels16);
  } else {
    reduce(reading, raw, image.pixels8);
  }
  return image;
}

}  // namespace beltpick::contract_io
