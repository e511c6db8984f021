// Frames on the wire: a message with a CRC-16 behind it, byte-stuffed (COBS, Cheshire and Baker 1999), ended by a zero.
// After any damage the next zero is the next chance: a receiver is never out of step for longer than one frame.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace beltpick {
namespace protocol {

// The longest message (header and payload), and the longest frame it can become.
constexpr size_t kMaxMessage = 176;
constexpr size_t kCrcBytes = 2;
constexpr size_t kMaxFrame = kMaxMessage + kCrcBytes + 2;  // one code byte (below 254 bytes one suffices) and the zero
static_assert(kMaxMessage + kCrcBytes < 254, "one COBS block");

// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no reflection; "123456789" gives 0x29B1.
constexpr uint16_t kCrcStart = 0xFFFF;
uint16_t crc16_step(uint16_t crc, uint8_t byte);
uint16_t crc16(const uint8_t* bytes, size_t count);

// Writes the frame of a message to `out`; the number of bytes written, 0 when it does not fit.
size_t encode_frame(const uint8_t* message, size_t size, uint8_t* out, size_t capacity);

// Takes the wire byte by byte.
class FrameDecoder {
 public:
  enum class Outcome : uint8_t { kMore, kMessage, kDamaged };

  // kMessage: message() and size() are valid until the next push. kDamaged: a frame ended that was not whole.
  Outcome push(uint8_t byte);

  const uint8_t* message() const { return buffer_; }
  size_t size() const { return size_; }

 private:
  Outcome finish();

  uint8_t buffer_[kMaxMessage + kCrcBytes] = {};
  size_t filled_ = 0;
  size_t size_ = 0;
  uint8_t block_left_ = 0;     // bytes until the next code byte
  bool zero_pending_ = false;  // the block before ended at a zero of the message
  bool started_ = false;
  bool overrun_ = false;
};

}  // namespace protocol
}  // namespace beltpick
