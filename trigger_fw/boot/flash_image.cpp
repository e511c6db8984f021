#include "boot/flash_image.hpp"

#include <algorithm>
#include <cstdio>

namespace beltpick {
namespace boot {

namespace {

constexpr std::uint32_t kBytesPerLine = 16;
enum RecordType : std::uint8_t {
  kData = 0,
  kEndOfFile = 1,
  kSegment = 2,
  kSegmentStart = 3,
  kLinear = 4,
  kLinearStart = 5
};

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

// The bytes of a line behind its colon; nothing when it is not of that form.
std::vector<std::uint8_t> line_bytes(const std::string& line) {
  std::vector<std::uint8_t> bytes;
  if (line.size() < 11 || line.size() % 2 == 0 || line[0] != ':') return {};
  for (std::size_t i = 1; i < line.size(); i += 2) {
    const int high = digit(line[i]);
    const int low = digit(line[i + 1]);
    if (high < 0 || low < 0) return {};
    bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
  }
  return bytes.size() == bytes[0] + std::size_t{5} ? bytes : std::vector<std::uint8_t>{};
}

class HexReader {
 public:
  explicit HexReader(FlashImage& image) : image_(image) {}

  bool ended() const { return ended_; }

  // Empty, or what is wrong with the line.
  const char* take(const std::string& line) {
    const std::vector<std::uint8_t> bytes = line_bytes(line);
    if (bytes.empty()) return "expected a line of Intel HEX, ':' and pairs of hexadecimal digits";
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : bytes) sum = static_cast<std::uint8_t>(sum + byte);
    if (sum != 0) return "its checksum is wrong: the file is damaged";
    const std::uint32_t value = bytes[0] >= 2 ? static_cast<std::uint32_t>(bytes[4] << 8 | bytes[5]) : 0;
    if (bytes[3] == kData) return put(bytes);
    if (bytes[3] == kEndOfFile) ended_ = true;
    if (bytes[3] == kSegment) base_ = value << 4U;
    if (bytes[3] == kLinear) base_ = value << 16U;
    return bytes[3] > kLinearStart ? "expected a record type of 0 to 5" : "";
  }

 private:
  const char* put(const std::vector<std::uint8_t>& bytes) {
    const std::uint32_t start = base_ + static_cast<std::uint32_t>(bytes[1] << 8 | bytes[2]);
    if (start > FlashImage::kCapacity - bytes[0]) return "its address is beyond the flash of every board";
    for (std::uint32_t i = 0; i < bytes[0]; ++i) image_.put(start + i, bytes[4 + i]);
    return "";
  }

  FlashImage& image_;
  std::uint32_t base_ = 0;
  bool ended_ = false;
};

std::string hex_line(std::uint8_t type, std::uint32_t address, const std::vector<std::uint8_t>& data) {
  std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(data.size()),
                                     static_cast<std::uint8_t>(address >> 8U & 0xFFU),
                                     static_cast<std::uint8_t>(address & 0xFFU), type};
  bytes.insert(bytes.end(), data.begin(), data.end());
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum = static_cast<std::uint8_t>(sum + byte);
  bytes.push_back(static_cast<std::uint8_t>(-sum));
  std::string line = ":";
  for (const std::uint8_t byte : bytes) {
    char text[3];
    std::snprintf(text, sizeof text, "%02X", unsigned{byte});
    line += text;
  }
  return line + "\n";
}

}  // namespace

void FlashImage::put(std::uint32_t at, std::uint8_t byte) {
  if (at >= bytes_.size()) {
    bytes_.resize(at + 1, 0xFF);
    given_.resize(at + 1, false);
  }
  bytes_[at] = byte;
  given_[at] = true;
}

void FlashImage::put(const FlashImage& other) {
  for (std::uint32_t at = 0; at < other.bytes_.size(); ++at) {
    if (other.given_[at]) put(at, other.bytes_[at]);
  }
}

std::uint32_t FlashImage::end(std::uint32_t limit) const {
  std::uint32_t at = std::min(limit, static_cast<std::uint32_t>(bytes_.size()));
  while (at > 0 && !given_[at - 1]) --at;
  return at;
}

std::string read_hex(const std::string& text, FlashImage& image) {
  HexReader reader(image);
  int number = 0;
  for (std::size_t from = 0; from < text.size() && !reader.ended();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    std::string line = text.substr(from, to - from);
    from = to + 1;
    ++number;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty()) continue;
    const std::string wrong = reader.take(line);
    if (!wrong.empty()) return "line " + std::to_string(number) + ": " + wrong;
  }
  return reader.ended() ? "" : "its last line (:00000001FF) is missing: the file is not whole";
}

std::string hex_text(const FlashImage& image) {
  std::string text;
  std::uint32_t base = 0;
  const std::uint32_t end = image.end();
  for (std::uint32_t at = 0; at < end;) {
    if (!image.has(at)) {
      ++at;
      continue;
    }
    if (at >> 16U != base) {
      base = at >> 16U;
      text += hex_line(kLinear, 0, {static_cast<std::uint8_t>(base >> 8U), static_cast<std::uint8_t>(base & 0xFFU)});
    }
    std::vector<std::uint8_t> data;
    const std::uint32_t start = at;
    do {
      data.push_back(image.byte(at++));
    } while (at % kBytesPerLine != 0 && image.has(at));
    text += hex_line(kData, start & 0xFFFFU, data);
  }
  return text + hex_line(kEndOfFile, 0, {});
}

}  // namespace boot
}  // namespace beltpick
