// The numbers and byte order of GigE Vision's two protocols: GVCP (control) and GVSP (stream).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace beltpick::virtual_cell::gige {

inline constexpr std::uint16_t kGvcpPort = 3956;
inline constexpr std::size_t kGvcpHeaderBytes = 8;
inline constexpr std::size_t kGvspHeaderBytes = 8;
inline constexpr std::size_t kIpUdpHeaderBytes = 28;  // counted in the packet size register

enum GvcpKey : std::uint8_t { kGvcpAck = 0x00, kGvcpCommand = 0x42 };

enum class GvcpMessage : std::uint16_t {
  kDiscovery = 0x0002,
  kPacketResend = 0x0040,
  kReadRegister = 0x0080,
  kWriteRegister = 0x0082,
  kReadMemory = 0x0084,
  kWriteMemory = 0x0086,
  kPending = 0x0089,
};

enum class GevStatus : std::uint16_t {
  kSuccess = 0x0000,
  kPacketResent = 0x0100,
  kNotImplemented = 0x8001,
  kInvalidAddress = 0x8003,
  kWriteProtect = 0x8004,
  kBadAlignment = 0x8005,
  kAccessDenied = 0x8006,
  kPacketUnavailable = 0x800c,
  kInvalidHeader = 0x800e,
};

enum class GvspContent : std::uint8_t { kLeader = 1, kTrailer = 2, kPayload = 3 };

inline void put16(std::uint8_t* at, std::uint32_t value) {
  at[0] = static_cast<std::uint8_t>(value >> 8U);
  at[1] = static_cast<std::uint8_t>(value);
}
inline void put32(std::uint8_t* at, std::uint32_t value) {
  put16(at, value >> 16U);
  put16(at + 2, value);
}
inline std::uint16_t get16(const std::uint8_t* at) { return static_cast<std::uint16_t>((at[0] << 8U) | at[1]); }
inline std::uint32_t get32(const std::uint8_t* at) {
  return (static_cast<std::uint32_t>(get16(at)) << 16U) | get16(at + 2);
}

}  // namespace beltpick::virtual_cell::gige
