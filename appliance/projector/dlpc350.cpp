#include "projector/dlpc350.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::projector {

namespace {

constexpr int kReply_ms = 1000;
constexpr int kPoll_ms = 10;

void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(kPoll_ms)); }

// The texts of all faults in `bits`, separated; empty where there is none.
template <std::size_t n>
std::array<char, 256> tell(const std::array<FaultBit, n>& faults, std::uint8_t bits) {
  std::array<char, 256> text{};
  std::size_t used = 0;
  for (const FaultBit& fault : faults) {
    if (((bits & fault.mask) != 0) != fault.bad_when) continue;
    const int more = std::snprintf(text.data() + used, text.size() - used, "%s%s", used == 0 ? "" : ", ", fault.text);
    used = std::min(text.size() - 1, used + static_cast<std::size_t>(std::max(0, more)));
  }
  return text;
}

// The same failure with the command in it.
std::unexpected<Error> during(const Error& error, const Command& command) {
  return failure(error.code, "%.250s (command 0x%04X, %s)", error.detail, command.number, command.name);
}

}  // namespace

// The reply's header must be this message's: a reply that came late belongs to another.
Result<void> Dlpc350::send(const Message& message, std::uint8_t flags, const Command& command, Report& reply) {
  channel_.drain();
  for (std::size_t i = 0; i < message.count; ++i) {
    if (const auto sent = channel_.send(message.reports[i]); !sent) return during(sent.error(), command);
  }
  const auto received = channel_.receive(kReply_ms);
  if (!received) return during(received.error(), command);
  reply = *received;
  const ReplyHeader header = reply_header(reply);
  const auto other_flags = static_cast<std::uint8_t>((header.flags ^ flags) & (kFlagRead | kFlagReply));
  if (header.sequence != sequence_ || other_flags != 0) {
    return failure(
        ResultCode::kProjectorWrongReply,
        "projector: expected the reply %02X %02X to command 0x%04X (%s), found %02X %02X; end other programs "
        "that talk to it, switch it off and on",
        flags, sequence_, command.number, command.name, header.flags, header.sequence);
  }
  if (header.error()) {
    return failure(ResultCode::kProjectorRefused,
                   "projector: refused command 0x%04X (%s); check its model and firmware, switch it off and on",
                   command.number, command.name);
  }
  return {};
}

Result<void> Dlpc350::write(const Command& command, std::span<const std::uint8_t> parameters) {
  Report reply{};
  ++sequence_;
  return send(write_message(sequence_, command.number, parameters), kFlagReply, command, reply);
}

Result<void> Dlpc350::read(const Command& command, std::span<std::uint8_t> data) {
  Report reply{};
  ++sequence_;
  const auto got = send(read_message(sequence_, command.number), kFlagRead | kFlagReply, command, reply);
  if (!got) return got;
  const std::uint16_t length = reply_header(reply).length;
  if (length < data.size() || length > kReportBytes - kHeaderBytes) {
    return failure(
        ResultCode::kProjectorWrongReply,
        "projector: expected at least %zu bytes in the reply to command 0x%04X (%s), found %u; check its firmware",
        data.size(), command.number, command.name, length);
  }
  std::copy_n(reply.begin() + kHeaderBytes, data.size(), data.begin());
  return {};
}

Result<std::uint8_t> Dlpc350::read_byte(const Command& command) {
  std::uint8_t byte = 0;
  const auto got = read(command, {&byte, 1});
  if (!got) return std::unexpected(got.error());
  return byte;
}

Result<FirmwareVersion> Dlpc350::version() {
  std::array<std::uint8_t, 16> bytes{};
  const auto got = read(kVersion, bytes);
  if (!got) return std::unexpected(got.error());
  return FirmwareVersion{bytes[3], bytes[2], bytes[0] | bytes[1] << 8};
}

Result<void> Dlpc350::switch_to(const Command& command, std::uint8_t parameter, int timeout_ms) {
  if (const auto written = write(command, parameter); !written) return written;
  const std::int64_t until_us = monotonic_us() + timeout_ms * 1000LL;
  for (;;) {
    const auto now = read_byte(command);
    if (!now) return std::unexpected(now.error());
    if (*now == parameter) return {};
    if (monotonic_us() > until_us) {
      return failure(ResultCode::kProjectorFault,
                     "projector: %s: expected %u within %d ms, found %u; check its video input and power", command.name,
                     parameter, timeout_ms, *now);
    }
    pause();
  }
}

Result<void> Dlpc350::write_table(TableOpen table, std::span<const std::uint8_t> bytes) {
  Result<void> done = write(kTableAccess, static_cast<std::uint8_t>(table));
  if (done) done = write(kTableOffset, 0);
  if (done) done = write(kTableData, bytes);
  if (done) done = write(kTableAccess, static_cast<std::uint8_t>(TableOpen::kNone));
  return done;
}

Result<void> Dlpc350::validate(int timeout_ms) {
  if (const auto begun = write(kValidate, 0); !begun) return begun;
  const std::int64_t until_us = monotonic_us() + timeout_ms * 1000LL;
  for (;;) {
    const auto bits = read_byte(kValidate);
    if (!bits) return std::unexpected(bits.error());
    if ((*bits & kValidating) == 0) {
      if (*bits == 0) return {};
      return failure(
          ResultCode::kProjectorRefused,
          "projector: its validation of the sequence found: %s; change exposure_us or period_us of the recipe",
          tell(kValidationFaults, *bits).data());
    }
    if (monotonic_us() > until_us) {
      return failure(ResultCode::kProjectorSilent,
                     "projector: expected its validation to end within %d ms, found it busy", timeout_ms);
    }
    pause();
  }
}

Result<void> Dlpc350::check_status(bool must_run) {
  const auto hardware = read_byte(kHardwareStatus);
  if (!hardware) return std::unexpected(hardware.error());
  const auto faults = tell(kHardwareFaults, *hardware);
  if (faults[0] != '\0') {
    return failure(ResultCode::kProjectorFault, "projector: it reports: %s; switch it off and on", faults.data());
  }
  const auto main_status = read_byte(kMainStatus);
  if (!main_status) return std::unexpected(main_status.error());
  if ((*main_status & kMirrorsParked) != 0) {
    return failure(ResultCode::kProjectorFault, "projector: its mirrors are parked; check its power, switch it on");
  }
  if (!must_run) return {};
  const auto run = read_byte(kStartStop);
  if (!run) return std::unexpected(run.error());
  if (*run != kStart) {
    return failure(ResultCode::kProjectorFault,
                   "projector: its sequence was stopped; check that TRIG_IN_2 is not pulled, switch it off and on");
  }
  return {};
}

}  // namespace beltpick::projector
