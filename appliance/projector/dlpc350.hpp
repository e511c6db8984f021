// Dlpc350: commands to the controller and its answers, each checked. The commands stand in dlpc350_commands.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/result.hpp"
#include "projector/dlpc350_commands.hpp"
#include "projector/hidraw.hpp"

namespace beltpick::projector {

struct FirmwareVersion {
  int major = 0, minor = 0, patch = 0;
};

class Dlpc350 {
 public:
  explicit Dlpc350(HidChannel channel) : channel_(std::move(channel)) {}

  // Errors of every command: kProjectorLost, kProjectorSilent, kProjectorRefused where its error bit came back,
  // kProjectorWrongReply where the reply is not one to this command.
  Result<void> write(const Command& command, std::span<const std::uint8_t> parameters);
  Result<void> write(const Command& command, std::uint8_t parameter) { return write(command, {&parameter, 1}); }
  // Fills `data`; the reply must have so many bytes, of 60 that one report can hold.
  Result<void> read(const Command& command, std::span<std::uint8_t> data);
  Result<std::uint8_t> read_byte(const Command& command);

  Result<FirmwareVersion> version();
  // Writes a parameter and waits until the controller says that it is so: modes change within some frames.
  Result<void> switch_to(const Command& command, std::uint8_t parameter, int timeout_ms);
  // Writes `bytes` into a table of the controller from its first entry.
  Result<void> write_table(TableOpen table, std::span<const std::uint8_t> bytes);
  // Validates what was written. Error: kProjectorRefused, naming what is wrong.
  Result<void> validate(int timeout_ms);
  // Error: kProjectorFault, naming the bits of hardware status that are wrong; parked mirrors; where it has to run, a
  // sequence that was stopped.
  Result<void> check_status(bool must_run);

 private:
  Result<void> send(const Message& message, std::uint8_t flags, const Command& command, Report& reply);

  HidChannel channel_;
  std::uint8_t sequence_ = 0;
};

}  // namespace beltpick::projector
