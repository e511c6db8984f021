// The four-phase handshake of commands: the PLC writes a command, the appliance echoes it when done or refused, the PLC
// writes 0, the appliance clears the echo. A pure state machine.
#pragma once

#include <cstdint>
#include <optional>

#include "contract/result_codes.hpp"

namespace beltpick::plc {

struct CommandRequest {
  std::uint16_t command = 0;   // as written; perhaps one that does not exist
  std::uint16_t argument = 0;  // as it stood when the command was written
  std::uint32_t ticket = 0;    // tells this request from an earlier one of the same number
};

class CommandHandshake {
 public:
  // After every write of the PLC: the present content of `command` and `command_argument`. A command that replaces
  // another without a 0 between is not seen until then.
  void written(std::uint16_t command, std::uint16_t argument);

  // The command that waits for its answer.
  [[nodiscard]] const std::optional<CommandRequest>& pending() const { return pending_; }

  // Answers the request of that ticket; an answer to a request the PLC has withdrawn is dropped.
  void answer(std::uint32_t ticket, ResultCode code);

  [[nodiscard]] std::uint16_t echo() const { return echo_; }
  [[nodiscard]] ResultCode result() const { return result_; }

 private:
  std::optional<CommandRequest> pending_;
  std::uint16_t echo_ = 0;
  ResultCode result_ = ResultCode::kOk;
  std::uint32_t tickets_ = 0;
};

}  // namespace beltpick::plc
