#include "plc/modbus_request.hpp"

namespace beltpick::plc {

namespace {

constexpr std::uint16_t kMaxRead = 125, kMaxWrite = 123, kMaxWriteOfReadWrite = 121;

std::uint16_t u16_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>((bytes[at] << 8U) | bytes[at + 1]);
}

// The value is judged before the address, as the specification's flow charts do.
ModbusException check_range(std::uint16_t address, std::uint16_t count, std::uint16_t max_count,
                            std::uint16_t registers) {
  if (count == 0 || count > max_count) return ModbusException::kIllegalValue;
  if (address + count > registers) return ModbusException::kIllegalAddress;
  return ModbusException::kNone;
}

// `pdu` from its function code on; start, quantity, byte count and values of a write begin at `at`.
ModbusException check_write(std::span<const std::uint8_t> pdu, std::size_t at, std::uint16_t max_count,
                            std::uint16_t registers) {
  if (pdu.size() < at + 5) return ModbusException::kIllegalValue;
  const std::uint16_t count = u16_at(pdu, at + 2);
  const std::size_t value_bytes = pdu[at + 4];
  if (value_bytes != 2U * count || pdu.size() != at + 5 + value_bytes) return ModbusException::kIllegalValue;
  return check_range(u16_at(pdu, at), count, max_count, registers);
}

ModbusException check_read_write(std::span<const std::uint8_t> pdu, std::uint16_t registers) {
  if (pdu.size() < 10) return ModbusException::kIllegalValue;
  const auto read = check_range(u16_at(pdu, 1), u16_at(pdu, 3), kMaxRead, registers);
  return read != ModbusException::kNone ? read : check_write(pdu, 5, kMaxWriteOfReadWrite, registers);
}

}  // namespace

Frame find_frame(std::span<const std::uint8_t> received) {
  if (received.size() < 6) return {FrameState::kIncomplete, 0};
  const std::uint16_t protocol = u16_at(received, 2);
  const std::size_t length = u16_at(received, 4);  // unit and what follows
  if (protocol != 0 || length < 2 || length + 6 > kMaxAduBytes) return {FrameState::kBroken, 0};
  if (received.size() < length + 6) return {FrameState::kIncomplete, 0};
  return {FrameState::kWhole, length + 6};
}

RequestCheck check_request(std::span<const std::uint8_t> adu, std::uint16_t holding_registers,
                           std::uint16_t input_registers) {
  const auto pdu = adu.subspan(kMbapBytes);
  switch (pdu[0]) {
    case 3:
    case 4: {
      const std::uint16_t registers = pdu[0] == 3 ? holding_registers : input_registers;
      if (pdu.size() != 5) return {ModbusException::kIllegalValue};
      return {check_range(u16_at(pdu, 1), u16_at(pdu, 3), kMaxRead, registers)};
    }
    case 6:
      if (pdu.size() != 5) return {ModbusException::kIllegalValue};
      return {check_range(u16_at(pdu, 1), 1, 1, holding_registers), true};
    case 16:
      return {check_write(pdu, 1, kMaxWrite, holding_registers), true};
    case 23:
      return {check_read_write(pdu, holding_registers), true};
    default:
      return {ModbusException::kIllegalFunction};
  }
}

}  // namespace beltpick::plc
