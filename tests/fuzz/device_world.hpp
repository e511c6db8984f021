// World: a Device with everything around it that the fuzzer can move: serial line, clock, camera, belt, emergency stop,
// START pin. After each step it checks what PROTOCOL.md promises.
#pragma once

#include <cstdint>
#include <optional>

#include "core/device.hpp"
#include "input.hpp"

namespace fuzz {

// What the inputs reached so far, so that a run that reaches nothing is noticed.
struct Reached {
  std::size_t running = 0;
  std::size_t done = 0;
  std::size_t faults = 0;
  std::size_t refusals = 0;
};

class World {
 public:
  // Powers the device up as the input says: reset cause, flash, input pins, and the clock's count.
  explicit World(Input& input);

  void step(Input& input);
  // From the state that it is in, by what an operator and a host can do, to a whole sequence.
  void check_way_out();

  [[nodiscard]] const Reached& reached() const { return reached_; }

 private:
  void send(Input& input);
  void send_arm(Input& input);
  template <class Payload>
  void post(beltpick::protocol::Type type, const Payload& payload);
  void let_pass(std::uint32_t ticks);
  void jump(std::uint32_t ticks);
  void set_inputs(std::uint8_t bits);
  void set_strobe(bool level);
  void listen();
  void take_message();
  void check();
  void check_edges_of_plan() const;
  void run_a_sequence();

  beltpick::core::Sequencer& sequencer() { return device_.sequencer(); }
  [[nodiscard]] beltpick::protocol::StatusReport status() const { return device_.sequencer().status(now_ticks_); }

  std::uint32_t now_ticks_;
  bool program_damaged_;
  beltpick::core::Device device_;
  beltpick::protocol::FrameDecoder host_;
  std::uint8_t sequence_ = 0;
  std::uint16_t arm_id_ = 0;
  bool camera_answers_ = true;
  std::optional<std::uint32_t> pulse_rose_ticks_;
  bool clock_jumped_ = false;  // within the pulse: its length says nothing then
  bool was_running_ = false;
  Reached reached_;
};

}  // namespace fuzz
