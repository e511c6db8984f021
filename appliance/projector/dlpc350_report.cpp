#include "projector/dlpc350_report.hpp"

#include <algorithm>

namespace beltpick::projector {

namespace {

Message message(std::uint8_t flags, std::uint8_t sequence, std::uint16_t command,
                std::span<const std::uint8_t> parameters) {
  const std::size_t length = kCommandBytes + parameters.size();
  std::array<std::uint8_t, kMaxReports * kReportBytes> bytes{};
  bytes[0] = flags;
  bytes[1] = sequence;
  bytes[2] = static_cast<std::uint8_t>(length);
  bytes[3] = static_cast<std::uint8_t>(length >> 8U);
  bytes[4] = static_cast<std::uint8_t>(command);
  bytes[5] = static_cast<std::uint8_t>(command >> 8U);
  std::copy(parameters.begin(), parameters.end(), bytes.begin() + kHeaderBytes + kCommandBytes);

  Message message;
  message.count = (kHeaderBytes + length + kReportBytes - 1) / kReportBytes;
  for (std::size_t i = 0; i < message.count; ++i) {
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(i * kReportBytes), kReportBytes,
                message.reports[i].begin());
  }
  return message;
}

}  // namespace

Message write_message(std::uint8_t sequence, std::uint16_t command, std::span<const std::uint8_t> parameters) {
  return message(kFlagReply, sequence, command, parameters);
}

Message read_message(std::uint8_t sequence, std::uint16_t command) {
  return message(kFlagRead | kFlagReply, sequence, command, {});
}

ReplyHeader reply_header(const Report& report) {
  return {report[0], report[1], static_cast<std::uint16_t>(report[2] | report[3] << 8U)};
}

}  // namespace beltpick::projector
