// PlcExchange: where the PLC's thread and the cycle's thread meet. Holds both register banks under one lock, so that
// each side sees whole updates only; nothing in it allocates.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>

#include "plc/command_handshake.hpp"
#include "plc/register_image.hpp"

namespace beltpick::plc {

// What the PLC last said.
struct PlcView {
  bool heard = false;  // it has written at least once since start
  bool belt_stopped = false;
  bool robot_clear = false;
  std::int64_t heartbeat_changed_us = 0;  // when `plc_heartbeat` last changed, or the first write came
  std::optional<CommandRequest> command;
};

class PlcExchange {
 public:
  explicit PlcExchange(WordOrder order) : order_(order) {}

  // The cycle's side. publish() also takes the answer to a command, so that echo and new state appear together.
  [[nodiscard]] PlcView view() const;
  struct Answer {
    std::uint32_t ticket = 0;
    ResultCode code = ResultCode::kOk;
  };
  void publish(const ApplianceRegisters& registers, std::optional<Answer> answer = std::nullopt);

  // From any thread: what was published last.
  [[nodiscard]] ApplianceRegisters published() const;

  // The Modbus server's side.
  void copy_inputs(InputImage to) const;
  void holding_written(std::span<const std::uint16_t, kHoldingRegisters> holding, std::int64_t now_us);

 private:
  void show_handshake();

  mutable std::mutex mutex_;
  WordOrder order_;
  std::array<std::uint16_t, kInputRegisters> inputs_{};
  ApplianceRegisters published_;
  CommandHandshake handshake_;
  PlcView view_;
  std::uint16_t heartbeat_ = 0;
};

}  // namespace beltpick::plc
