// Uncompressed BMP of 1, 4, 8 (paletted), 16, 24 and 32 bits a pixel, rows bottom-up or top-down.
// Source: Microsoft's BITMAPFILEHEADER, BITMAPCOREHEADER, BITMAPINFOHEADER and BITMAPV4HEADER.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "contract/result_codes.hpp"
#include "contract_io/image_formats.hpp"

namespace beltpick::contract_io {
namespace {

constexpr std::size_t kFileHeaderBytes = 14;
constexpr std::uint32_t kCoreHeaderBytes = 12;
constexpr std::uint32_t kInfoHeaderBytes = 40;
enum Compression : std::uint32_t { kPlain = 0, kBitFields = 3, kAlphaBitFields = 6 };

// Little-endian numbers out of the file; what lies beyond its end reads as 0 and is remembered.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] std::uint32_t u8(std::size_t at) {
    if (at >= bytes_.size()) {
      short_ = true;
      return 0;
    }
    return static_cast<unsigned char>(bytes_[at]);
  }
  [[nodiscard]] std::uint32_t u16(std::size_t at) { return u8(at) | u8(at + 1) << 8U; }
  [[nodiscard]] std::uint32_t u32(std::size_t at) { return u16(at) | u16(at + 2) << 16U; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] bool ended() const { return short_; }
  [[nodiscard]] const unsigned char* at(std::size_t offset) const {
    return reinterpret_cast<const unsigned char*>(bytes_.data()) + offset;
  }

 private:
  std::string_view bytes_;
  bool short_ = false;
};

struct BmpHeader {
  std::size_t pixels_at = 0;
  std::int64_t cols = 0, rows = 0;
  bool top_down = false;
  std::uint32_t bits = 0;
  std::uint32_t compression = kPlain;
  std::size_t palette_at = 0;
  std::size_t palette_entry_bytes = 4;
  std::uint32_t palette_entries = 0;
  std::array<std::uint32_t, 3> masks{};  // red, green, blue; of 16 and 32 bits a pixel

  [[nodiscard]] std::size_t row_bytes() const { return (static_cast<std::size_t>(cols) * bits + 31) / 32 * 4; }
};

void read_info_header(Bytes& file, std::uint32_t header_bytes, BmpHeader& header) {
  header.cols = static_cast<std::int32_t>(file.u32(18));
  const auto height = static_cast<std::int32_t>(file.u32(22));
  header.top_down = height < 0;
  header.rows = std::abs(static_cast<std::int64_t>(height));
  header.bits = file.u16(28);
  header.compression = file.u32(30);
  header.palette_entries = file.u32(46);
  header.palette_at = kFileHeaderBytes + header_bytes;
  if (header.compression == kBitFields || header.compression == kAlphaBitFields) {
    for (std::size_t i = 0; i < 3; ++i) header.masks[i] = file.u32(54 + 4 * i);
  } else if (header.bits == 16) {
    header.masks = {0x7c00, 0x03e0, 0x001f};
  } else {
    header.masks = {0xff0000, 0x00ff00, 0x0000ff};
  }
}

void read_core_header(Bytes& file, BmpHeader& header) {
  header.cols = file.u16(18);
  header.rows = file.u16(20);
  header.bits = file.u16(24);
  header.palette_at = kFileHeaderBytes + kCoreHeaderBytes;
  header.palette_entry_bytes = 3;
  header.masks = {0xff0000, 0x00ff00, 0x0000ff};
}

Result<void> judge(const BmpHeader& header, const Bytes& file, const std::string& name) {
  const auto bad = [&](const char* member, const char* expected, long long found) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: BMP %s: expected %s, found %lld; save it as uncompressed BMP or as PNG", name.c_str(), member,
                   expected, found);
  };
  constexpr std::array<std::uint32_t, 6> kDepths{1, 4, 8, 16, 24, 32};
  if (std::find(kDepths.begin(), kDepths.end(), header.bits) == kDepths.end()) {
    return bad("bits a pixel", "1, 4, 8, 16, 24 or 32", header.bits);
  }
  const bool masked = header.compression == kBitFields || header.compression == kAlphaBitFields;
  if (header.compression != kPlain && !(masked && (header.bits == 16 || header.bits == 32))) {
    return bad("compression", "none (0)", header.compression);
  }
  if (header.cols <= 0) return bad("width", "at least 1", header.cols);
  if (header.rows <= 0) return bad("height", "at least 1", header.rows);
  if (header.cols > kMaxPixels / header.rows) return bad("width x height", "at most 200 million pixels", header.cols);
  const std::size_t needed = header.pixels_at + header.row_bytes() * static_cast<std::size_t>(header.rows);
  if (file.ended() || header.pixels_at > file.size() || needed > file.size()) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: expected a BMP of %zu bytes, found %zu; the file is cut off: copy it again", name.c_str(),
                   needed, file.size());
  }
  return {};
}

struct Palette {
  std::array<std::uint8_t, 256> grey{};
  bool colour = false;
};

Palette read_palette(Bytes& file, const BmpHeader& header) {
  Palette palette;
  const std::uint32_t most = 1U << header.bits;
  std::uint32_t entries = header.palette_entries == 0 ? most : std::min(header.palette_entries, most);
  const std::size_t room = header.pixels_at > header.palette_at ? header.pixels_at - header.palette_at : 0;
  entries = std::min(entries, static_cast<std::uint32_t>(room / header.palette_entry_bytes));
  for (std::uint32_t i = 0; i < entries; ++i) {
    const std::size_t at = header.palette_at + i * header.palette_entry_bytes;
    const std::uint32_t blue = file.u8(at);
    const std::uint32_t green = file.u8(at + 1);
    const std::uint32_t red = file.u8(at + 2);
    palette.grey[i] = static_cast<std::uint8_t>(grey_from_rgb(red, green, blue));
    palette.colour = palette.colour || red != green || red != blue;
  }
  return palette;
}

// The channel under `mask`, scaled to 0..255.
std::uint32_t channel(std::uint32_t pixel, std::uint32_t mask) {
  if (mask == 0) return 0;
  const std::uint64_t low = mask & (~mask + 1U);
  const std::uint64_t most = mask / low;
  return static_cast<std::uint32_t>(((pixel & mask) / low * 255 + most / 2) / most);
}

void read_indexed_row(const unsigned char* row, std::uint32_t bits, const Palette& palette, std::uint8_t* out,
                      int cols) {
  const std::uint32_t per_byte = 8 / bits;
  for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(cols); ++c) {
    const std::uint32_t shift = 8 - bits * (c % per_byte + 1);
    out[c] = palette.grey[(row[c / per_byte] >> shift) & ((1U << bits) - 1U)];
  }
}

void read_direct_row(const unsigned char* row, const BmpHeader& header, std::uint8_t* out, int cols) {
  const std::size_t bytes = header.bits / 8;
  for (int c = 0; c < cols; ++c) {
    std::uint32_t pixel = 0;
    for (std::size_t b = 0; b < bytes; ++b) {
      pixel |= static_cast<std::uint32_t>(row[static_cast<std::size_t>(c) * bytes + b]) << (8 * b);
    }
    out[c] = static_cast<std::uint8_t>(grey_from_rgb(channel(pixel, header.masks[0]), channel(pixel, header.masks[1]),
                                                     channel(pixel, header.masks[2])));
  }
}

}  // namespace

bool looks_like_bmp(std::string_view bytes) { return bytes.starts_with("BM"); }

Result<GreyImage> decode_bmp(std::string_view bytes, const std::string& name) {
  Bytes file(bytes);
  BmpHeader header;
  header.pixels_at = file.u32(10);
  const std::uint32_t header_bytes = file.u32(14);
  if (header_bytes == kCoreHeaderBytes) {
    read_core_header(file, header);
  } else if (header_bytes >= kInfoHeaderBytes && header_bytes <= 1024) {
    read_info_header(file, header_bytes, header);
  } else {
    return failure(ResultCode::kFormatInvalid,
                   "%s: BMP header size: expected 12 or 40 to 124, found %u; save it as PNG", name.c_str(),
                   header_bytes);
  }
  if (const auto good = judge(header, file, name); !good) return std::unexpected(good.error());

  GreyImage image;
  image.rows = static_cast<int>(header.rows);
  image.cols = static_cast<int>(header.cols);
  image.pixels8.resize(static_cast<std::size_t>(header.rows * header.cols));
  const Palette palette = header.bits <= 8 ? read_palette(file, header) : Palette{};
  image.from_colour = header.bits > 8 || palette.colour;
  for (int r = 0; r < image.rows; ++r) {
    const int stored = header.top_down ? r : image.rows - 1 - r;
    const unsigned char* row = file.at(header.pixels_at + header.row_bytes() * static_cast<std::size_t>(stored));
    std::uint8_t* out = image.pixels8.data() + static_cast<std::ptrdiff_t>(r) * image.cols;
    if (header.bits <= 8) {
      read_indexed_row(row, header.bits, palette, out, image.cols);
    } else {
      read_direct_row(row, header, out, image.cols);
    }
  }
  return image;
}

}  // namespace beltpick::contract_io
