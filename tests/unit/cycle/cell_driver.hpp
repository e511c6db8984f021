// Drives a Cycle the way the appliance does: keeps the inputs, lets time pass, takes reports and commands once.
#pragma once

#include <vector>

#include "cycle/cycle.hpp"

namespace beltpick::cycle {

class CellDriver {
 public:
  CycleConfig config;
  Cycle cycle{config};
  CycleInputs in;
  std::vector<LocatedPart> parts;
  std::vector<Action> actions;  // of the last step

  explicit CellDriver(CycleConfig config_ = {}) : config(config_), cycle(config_) {
    in.line_belt_stopped = in.register_belt_stopped = in.robot_clear = true;
    in.recipe_known = true;
    in.now_us = 1'000'000;
  }

  [[nodiscard]] CellState state() const { return cycle.status().state; }
  [[nodiscard]] const CycleStatus& status() const { return cycle.status(); }

  void step(std::int64_t later_us = 1000) {
    in.now_us += later_us;
    const Actions decided = cycle.step(in);
    actions.assign(decided.list().begin(), decided.list().end());
    in.capture = {};
    in.locate = {};
    in.model_changed = false;
    in.command = 0;
  }

  // The result code of the answer, or kInternal when there was none.
  ResultCode command(PlcCommand command, std::uint16_t argument = 0) {
    in.command = static_cast<std::uint16_t>(command);
    in.command_argument = argument;
    step();
    for (const Action& action : actions) {
      if (action.kind == ActionKind::kAnswerCommand) return action.code;
    }
    return ResultCode::kInternal;
  }

  ResultCode answer_offer(PlcCommand with) { return command(with, status().offer_sequence); }

  void capture_ended(ResultCode code = ResultCode::kOk) {
    in.capture = {true, status().capture, code};
    step();
  }

  void locate_ended(ResultCode code = ResultCode::kOk, int withheld = 0,
                    ResultCode withheld_code = ResultCode::kNoHypothesis) {
    in.locate = {true, status().capture, code, parts, withheld, withheld_code};
    step();
  }

  void add_part(bool touches = false, int grasp = 0) {
    LocatedPart part;
    part.touches_neighbour = touches;
    part.grasp_index = grasp;
    parts.push_back(part);
  }

  [[nodiscard]] const Action* find(ActionKind kind) const {
    for (const Action& action : actions) {
      if (action.kind == kind) return &action;
    }
    return nullptr;
  }

  // Brings a new cell into a state by the shortest legal way.
  void bring_to(CellState wanted) {
    if (parts.empty()) add_part();
    if (wanted == CellState::kStarting) return;
    step();
    if (wanted == CellState::kIdle) return;
    if (wanted == CellState::kFault) {
      in.emergency_stop = true;
      step();
      in.emergency_stop = false;
      step();
      return;
    }
    if (wanted == CellState::kBeltReleased) {
      command(PlcCommand::kEndCycle);
      return;
    }
    command(PlcCommand::kStartCycle);
    if (wanted == CellState::kSettling) return;
    step();
    step(config.rest.settle_us);
    if (wanted == CellState::kCapturing) return;
    capture_ended();
    if (wanted == CellState::kProcessing) return;
    locate_ended();
  }
};

inline constexpr CellState kAllStates[] = {CellState::kStarting,     CellState::kIdle,       CellState::kSettling,
                                           CellState::kCapturing,    CellState::kProcessing, CellState::kOffering,
                                           CellState::kBeltReleased, CellState::kFault};

}  // namespace beltpick::cycle
