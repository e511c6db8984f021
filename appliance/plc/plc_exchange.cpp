#include "plc/plc_exchange.hpp"

#include <algorithm>

namespace beltpick::plc {

PlcView PlcExchange::view() const {
  const std::lock_guard lock(mutex_);
  PlcView view = view_;
  view.command = handshake_.pending();
  return view;
}

void PlcExchange::publish(const ApplianceRegisters& registers, std::optional<Answer> answer) {
  const std::lock_guard lock(mutex_);
  published_ = registers;
  encode(registers, order_, inputs_);
  if (answer) handshake_.answer(answer->ticket, answer->code);
  show_handshake();
}

ApplianceRegisters PlcExchange::published() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

void PlcExchange::copy_inputs(InputImage to) const {
  const std::lock_guard lock(mutex_);
  std::copy(inputs_.begin(), inputs_.end(), to.begin());
}

void PlcExchange::holding_written(std::span<const std::uint16_t, kHoldingRegisters> holding, std::int64_t now_us) {
  const std::lock_guard lock(mutex_);
  const std::uint16_t status = holding[register_address("plc_status")];
  view_.belt_stopped = (status & kPlcBeltStopped) != 0;
  view_.robot_clear = (status & kPlcRobotClear) != 0;
  const std::uint16_t heartbeat = holding[register_address("plc_heartbeat")];
  if (!view_.heard || heartbeat != heartbeat_) view_.heartbeat_changed_us = now_us;
  heartbeat_ = heartbeat;
  view_.heard = true;
  handshake_.written(holding[register_address("command")], holding[register_address("command_argument")]);
  show_handshake();
}

void PlcExchange::show_handshake() {
  inputs_[register_address("command_result")] = static_cast<std::uint16_t>(handshake_.result());
  inputs_[register_address("command_echo")] = handshake_.echo();
}

}  // namespace beltpick::plc
