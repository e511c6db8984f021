// Input: the fuzzer's bytes, taken one after the other as the numbers that a target needs; zeros behind their end.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fuzz {

class Input {
 public:
  Input(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes), size_(size) {}

  [[nodiscard]] bool ended() const { return at_ == size_; }
  std::uint8_t u8() { return ended() ? std::uint8_t{0} : bytes_[at_++]; }
  std::uint16_t u16() {
    const unsigned low = u8();
    return static_cast<std::uint16_t>(low | static_cast<unsigned>(u8()) << 8U);
  }
  std::uint32_t u32() {
    const std::uint32_t low = u16();
    return low | static_cast<std::uint32_t>(u16()) << 16U;
  }

 private:
  const std::uint8_t* bytes_;
  std::size_t size_;
  std::size_t at_ = 0;
};

}  // namespace fuzz
