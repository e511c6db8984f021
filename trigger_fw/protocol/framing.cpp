#include "protocol/framing.hpp"

namespace beltpick {
namespace protocol {

uint16_t crc16_step(uint16_t crc, uint8_t byte) {
  // The eight shifts at once: what leaves the register comes back at the polynomial's bits 0, 5 and 12.
  uint8_t leaving = static_cast<uint8_t>((crc >> 8U) ^ byte);
  leaving = static_cast<uint8_t>(leaving ^ (leaving >> 4U));
  const uint16_t wide = leaving;
  return static_cast<uint16_t>((crc << 8U) ^ (wide << 12U) ^ (wide << 5U) ^ wide);
}

uint16_t crc16(const uint8_t* bytes, size_t count) {
  uint16_t crc = kCrcStart;
  for (size_t i = 0; i < count; ++i) crc = crc16_step(crc, bytes[i]);
  return crc;
}

size_t encode_frame(const uint8_t* message, size_t size, uint8_t* out, size_t capacity) {
  if (size == 0 || size > kMaxMessage || capacity < size + kCrcBytes + 2) return 0;
  const uint16_t crc = crc16(message, size);
  size_t code_at = 0;
  size_t at = 1;
  for (size_t i = 0; i < size + kCrcBytes; ++i) {
    const uint8_t byte = i < size ? message[i] : static_cast<uint8_t>(i == size ? crc & 0xFFU : crc >> 8U);
    if (byte == 0) {
      out[code_at] = static_cast<uint8_t>(at - code_at);
      code_at = at++;
    } else {
      out[at++] = byte;
    }
  }
  out[code_at] = static_cast<uint8_t>(at - code_at);
  out[at++] = 0;
  return at;
}

FrameDecoder::Outcome FrameDecoder::push(uint8_t byte) {
  if (byte == 0) return finish();
  if (block_left_ == 0) {
    if (zero_pending_) {
      if (filled_ < sizeof buffer_) {
        buffer_[filled_++] = 0;
      } else {
        overrun_ = true;
      }
    }
    block_left_ = static_cast<uint8_t>(byte - 1);
    zero_pending_ = byte != 0xFF;
    started_ = true;
    return Outcome::kMore;
  }
  --block_left_;
  if (filled_ < sizeof buffer_) {
    buffer_[filled_++] = byte;
  } else {
    overrun_ = true;
  }
  return Outcome::kMore;
}

FrameDecoder::Outcome FrameDecoder::finish() {
  const bool empty = !started_;
  bool whole = !overrun_ && block_left_ == 0 && filled_ > kCrcBytes;
  if (whole) {
    size_ = filled_ - kCrcBytes;
    const uint16_t sent = static_cast<uint16_t>(buffer_[size_] | static_cast<uint16_t>(buffer_[size_ + 1]) << 8U);
    whole = crc16(buffer_, size_) == sent;
  }
  filled_ = 0;
  block_left_ = 0;
  zero_pending_ = started_ = overrun_ = false;
  if (empty) return Outcome::kMore;  // zeros in a row only separate
  return whole ? Outcome::kMessage : Outcome::kDamaged;
}

}  // namespace protocol
}  // namespace beltpick
