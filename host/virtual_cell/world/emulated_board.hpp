// EmulatedBoard: the trigger box as the firmware's real ELF, which trigger_emulator runs in a process of its own; its
// pins come over a socket (host/pin_link.hpp).
#pragma once

#include <sys/types.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "host/pin_link.hpp"
#include "virtual_cell/world/trigger_board.hpp"

namespace beltpick::virtual_cell {

class EmulatedBoard final : public TriggerBoard {
 public:
  // Starts the emulator and waits until its firmware runs.
  static Result<std::unique_ptr<TriggerBoard>> start(const TriggerBoardChoice& choice, const std::string& link,
                                                     OnEdge on_edge);
  ~EmulatedBoard() override;
  EmulatedBoard(const EmulatedBoard&) = delete;
  EmulatedBoard& operator=(const EmulatedBoard&) = delete;

  [[nodiscard]] std::string tty() const override { return line_; }
  void set_strobe(bool active) override;
  void set_belt_stopped(bool stopped) override { set_input(host::InputPin::kBeltStopped, stopped, 0); }
  void set_emergency_stop(bool pressed) override { set_input(host::InputPin::kEmergencyStop, pressed, 0); }
  void hang() override;
  void set_line_noise(double share) override;
  void cut_line(bool cut) override;

 private:
  EmulatedBoard(int socket, pid_t process, std::string line, OnEdge on_edge);

  void run();
  void pass_edge(const host::PinMessage& message);
  void set_input(host::InputPin pin, bool level, std::uint64_t after_cycles);

  host::PinLink link_;
  const pid_t process_;
  const std::string line_;
  const OnEdge on_edge_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::thread::id> in_edge_;  // the thread that is within on_edge_: the board's time stands still for it
  std::thread thread_;
};

}  // namespace beltpick::virtual_cell
