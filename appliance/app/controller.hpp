// Controller: the cycle's thread. Gathers signals, PLC and outcomes for the state machine, carries out what it decides,
// and shows the result in the registers. Allocates nothing after construction.
#pragma once

#include <cstdint>

#include "app/digital_lines.hpp"
#include "app/log.hpp"
#include "app/models.hpp"
#include "app/refused_grasps.hpp"
#include "app/run_book.hpp"
#include "app/vision.hpp"
#include "cycle/cycle.hpp"
#include "plc/plc_exchange.hpp"

namespace beltpick::app {

class Controller {
 public:
  struct Neighbours {
    Vision& vision;
    DigitalLines& lines;
    Models& models;
    plc::PlcExchange& plc;
    Log& log;
    RunBook& book;
    RefusedGrasps& refused;
  };

  Controller(const cycle::CycleConfig& config, std::int64_t plc_timeout_us, const Neighbours& neighbours);

  // One look at everything; call every few milliseconds.
  void step(std::int64_t now_us);

  [[nodiscard]] const cycle::CycleStatus& status() const { return cycle_.status(); }

 private:
  cycle::CycleInputs gather(std::int64_t now_us, const plc::PlcView& plc);
  void carry_out(const cycle::Action& action);
  void make_offer(const cycle::Action& action);
  void refuse_grasp(int offered_part);
  void keep_books(const cycle::CycleStatus& before, std::uint16_t answered_command, ResultCode answer);
  void tell_changes(const cycle::CycleStatus& before, std::uint16_t answered_command, ResultCode answer);
  [[nodiscard]] plc::ApplianceRegisters registers(std::int64_t now_us) const;

  cycle::Cycle cycle_;
  std::int64_t plc_timeout_us_;
  Neighbours to_;
  std::span<const LocatedPart> parts_;  // of the present view
  plc::PoseBlock offer_;
};

const char* state_name(CellState state);

}  // namespace beltpick::app
