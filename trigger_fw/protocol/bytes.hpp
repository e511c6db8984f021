// Reader and Writer: little-endian fields of a message, bounds checked. A message lists its fields once, in fields(io),
// and both directions walk that list, so they cannot differ.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace beltpick {
namespace protocol {

class Writer {
 public:
  Writer(uint8_t* out, size_t capacity) : out_(out), capacity_(capacity) {}

  void u8(uint8_t value) {
    if (size_ == capacity_) {
      ok_ = false;
      return;
    }
    out_[size_++] = value;
  }
  void u16(uint16_t value) {
    u8(static_cast<uint8_t>(value & 0xFFU));
    u8(static_cast<uint8_t>(value >> 8U));
  }
  void u32(uint32_t value) {
    u16(static_cast<uint16_t>(value & 0xFFFFU));
    u16(static_cast<uint16_t>(value >> 16U));
  }
  template <class Enum>
  void enumerator(Enum value) {
    u8(static_cast<uint8_t>(value));
  }

  // False when the buffer was too small.
  bool ok() const { return ok_; }
  size_t size() const { return size_; }

 private:
  uint8_t* out_;
  size_t capacity_;
  size_t size_ = 0;
  bool ok_ = true;
};

class Reader {
 public:
  Reader(const uint8_t* in, size_t size) : in_(in), size_(size) {}

  void u8(uint8_t& value) {
    value = 0;
    if (at_ == size_) {
      ok_ = false;
      return;
    }
    value = in_[at_++];
  }
  void u16(uint16_t& value) {
    uint8_t low, high;
    u8(low);
    u8(high);
    value = static_cast<uint16_t>(low | static_cast<uint16_t>(high) << 8U);
  }
  void u32(uint32_t& value) {
    uint16_t low, high;
    u16(low);
    u16(high);
    value = low | static_cast<uint32_t>(high) << 16U;
  }
  template <class Enum>
  void enumerator(Enum& value) {
    uint8_t number;
    u8(number);
    value = static_cast<Enum>(number);
  }

  // True when every field was there and nothing is left over.
  bool whole() const { return ok_ && at_ == size_; }

 private:
  const uint8_t* in_;
  size_t size_;
  size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace protocol
}  // namespace beltpick
