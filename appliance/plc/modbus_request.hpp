// Checks one Modbus TCP request before libmodbus answers it. libmodbus waits out its response timeout on a request that
// it finds malformed, which would stall every other client; so it only ever sees requests that are good.
// Source: MODBUS Application Protocol V1.1b3, MODBUS Messaging on TCP/IP V1.0b.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace beltpick::plc {

inline constexpr std::size_t kMbapBytes = 7;  // transaction, protocol, length, unit
inline constexpr std::size_t kMaxAduBytes = 260;

enum class FrameState : std::uint8_t {
  kIncomplete,  // more bytes are needed
  kWhole,       // `bytes` of them make one request
  kBroken,      // not Modbus: there is no way to find the next request; drop the connection
};
struct Frame {
  FrameState state = FrameState::kIncomplete;
  std::size_t bytes = 0;
};

// Finds the first request in what has been received.
Frame find_frame(std::span<const std::uint8_t> received);

enum class ModbusException : std::uint8_t { kNone = 0, kIllegalFunction = 1, kIllegalAddress = 2, kIllegalValue = 3 };

struct RequestCheck {
  ModbusException exception = ModbusException::kNone;
  bool writes = false;  // it changes holding registers
};

// Judges a whole request (header included): function 3, 4, 6, 16 or 23, lengths that agree, addresses that exist.
RequestCheck check_request(std::span<const std::uint8_t> adu, std::uint16_t holding_registers,
                           std::uint16_t input_registers);

}  // namespace beltpick::plc
