// Messages of the DLPC350 (the controller of the LightCrafter 4500) as USB HID reports of 64 bytes, unnumbered.
// Source: Texas Instruments DLPU010, "USB Interface": transaction structure, read and write sequence.
//
//   byte 0    flags: bit 7 read (1) or write (0); bit 6 a reply is wanted; bit 5 error, in replies; bits 2:0
//   destination,
//             0 = projector control
//   byte 1    sequence number: comes back in the reply
//   byte 2,3  length, low byte first: of what follows, the command's two bytes included
//   byte 4,5  command, low byte (CMD3) before high byte (CMD2); not in the reply of a read
//   byte 6..  parameters; what does not fit goes on at byte 0 of the next report
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace beltpick::projector {

inline constexpr std::size_t kReportBytes = 64;
inline constexpr std::size_t kHeaderBytes = 4;
inline constexpr std::size_t kCommandBytes = 2;
inline constexpr std::size_t kMaxParameters = 512;
inline constexpr std::size_t kMaxReports =
    (kHeaderBytes + kCommandBytes + kMaxParameters + kReportBytes - 1) / kReportBytes;

inline constexpr std::uint8_t kFlagRead = 0x80;
inline constexpr std::uint8_t kFlagReply = 0x40;
inline constexpr std::uint8_t kFlagError = 0x20;

using Report = std::array<std::uint8_t, kReportBytes>;

// The reports of one message.
struct Message {
  std::array<Report, kMaxReports> reports{};
  std::size_t count = 0;
};

// A write of `parameters`, at most kMaxParameters; a read carries none.
Message write_message(std::uint8_t sequence, std::uint16_t command, std::span<const std::uint8_t> parameters);
Message read_message(std::uint8_t sequence, std::uint16_t command);

struct ReplyHeader {
  std::uint8_t flags = 0;
  std::uint8_t sequence = 0;
  std::uint16_t length = 0;  // of the data behind it

  [[nodiscard]] bool error() const { return (flags & kFlagError) != 0; }
};

ReplyHeader reply_header(const Report& report);

}  // namespace beltpick::projector
