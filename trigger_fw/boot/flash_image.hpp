// FlashImage: what a hex file puts into a flash, byte by byte, and the Intel HEX text of it. For programs of the PC.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace beltpick {
namespace boot {

class FlashImage {
 public:
  static constexpr std::uint32_t kCapacity = 0x40000;  // the largest flash of a board

  // `at` below kCapacity.
  void put(std::uint32_t at, std::uint8_t byte);
  void put(const FlashImage& other);

  bool has(std::uint32_t at) const { return at < bytes_.size() && given_[at]; }
  // 0xFF, as in an erased flash, where nothing was put.
  std::uint8_t byte(std::uint32_t at) const { return has(at) ? bytes_[at] : 0xFF; }
  // Behind the last byte below `limit`; 0 when there is none.
  std::uint32_t end(std::uint32_t limit = kCapacity) const;

 private:
  std::vector<std::uint8_t> bytes_;
  std::vector<bool> given_;
};

// Adds what an Intel HEX text holds. Empty when it went well, else where it is wrong and how, for a person.
std::string read_hex(const std::string& text, FlashImage& image);
std::string hex_text(const FlashImage& image);

}  // namespace boot
}  // namespace beltpick
