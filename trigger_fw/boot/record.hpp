// Record: what the flash says of the firmware in it. The loader starts nothing without a record that is right; it is
// erased before the first page of a new firmware is written, and written after the last.
#pragma once

#include "boot/layout.hpp"
#include "protocol/bytes.hpp"
#include "protocol/framing.hpp"

namespace beltpick {
namespace boot {

constexpr uint32_t kRecordMagic = 0x57465042;  // "BPFW"

struct Record {
  uint32_t magic = kRecordMagic;
  protocol::BoardKind board = protocol::BoardKind::kHost;
  uint8_t major = 0;
  uint8_t minor = 0;
  uint8_t patch = 0;
  uint32_t length = 0;     // of the firmware, from address 0
  uint16_t flash_crc = 0;  // CRC-16 of these bytes, as IDENTITY tells it

  template <class Io>
  void fields(Io& io) {
    io.u32(magic);
    io.enumerator(board);
    io.u8(major);
    io.u8(minor);
    io.u8(patch);
    io.u32(length);
    io.u16(flash_crc);
  }
};

// Writes the record, with a CRC-16 of its own behind it.
inline void encode_record(Record record, uint8_t (&out)[kRecordBytes]) {
  protocol::Writer writer(out, kRecordBytes);
  record.fields(writer);
  writer.u16(protocol::crc16(out, kRecordBytes - protocol::kCrcBytes));
}

// False where there is no record, or a damaged one.
inline bool decode_record(const uint8_t (&bytes)[kRecordBytes], Record& record) {
  protocol::Reader reader(bytes, kRecordBytes);
  record.fields(reader);
  uint16_t sent;
  reader.u16(sent);
  return reader.whole() && record.magic == kRecordMagic &&
         sent == protocol::crc16(bytes, kRecordBytes - protocol::kCrcBytes);
}

}  // namespace boot
}  // namespace beltpick
