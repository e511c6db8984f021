#include "plc/command_handshake.hpp"

namespace beltpick::plc {

void CommandHandshake::written(std::uint16_t command, std::uint16_t argument) {
  if (command == 0) {
    pending_.reset();
    echo_ = 0;
    result_ = ResultCode::kOk;
  } else if (!pending_ && echo_ == 0) {
    pending_ = CommandRequest{command, argument, ++tickets_};
  }
}

void CommandHandshake::answer(std::uint32_t ticket, ResultCode code) {
  if (!pending_ || pending_->ticket != ticket) return;
  echo_ = pending_->command;
  result_ = code;
  pending_.reset();
}

}  // namespace beltpick::plc
