#include "app/controller.hpp"

#include <array>
#include <cstdio>
#include <optional>

namespace beltpick::app {

using cycle::Action;
using cycle::ActionKind;

namespace {

constexpr std::int64_t kHeartbeat_us = 100'000;

const char* command_name(std::uint16_t command) {
  switch (static_cast<PlcCommand>(command)) {
    case PlcCommand::kNone:
      return "none";
    case PlcCommand::kStartCycle:
      return "start cycle";
    case PlcCommand::kPickDone:
      return "pick done";
    case PlcCommand::kPickFailed:
      return "pick failed";
    case PlcCommand::kSkipPart:
      return "skip part";
    case PlcCommand::kEndCycle:
      return "end cycle";
    case PlcCommand::kClearFault:
      return "clear fault";
    case PlcCommand::kSelectRecipe:
      return "select recipe";
  }
  return "unknown";
}

}  // namespace

const char* state_name(CellState state) {
  constexpr std::array names{"starting",   "idle",     "settling",      "capturing",
                             "processing", "offering", "belt released", "fault"};
  return names[static_cast<std::size_t>(state)];
}

Controller::Controller(const cycle::CycleConfig& config, std::int64_t plc_timeout_us, const Neighbours& neighbours)
    : cycle_(config), plc_timeout_us_(plc_timeout_us), to_(neighbours) {}

void Controller::step(std::int64_t now_us) {
  const plc::PlcView plc = to_.plc.view();
  const cycle::CycleStatus before = cycle_.status();
  const cycle::CycleInputs inputs = gather(now_us, plc);
  if (inputs.locate.ended) parts_ = inputs.locate.parts;
  const cycle::Actions actions = cycle_.step(inputs);

  std::optional<plc::PlcExchange::Answer> answer;
  for (const Action& action : actions.list()) {
    if (action.kind == ActionKind::kAnswerCommand && plc.command) answer = {plc.command->ticket, action.code};
  }
  const std::uint16_t answered = answer ? inputs.command : std::uint16_t{0};
  const ResultCode code = answer ? answer->code : ResultCode::kOk;
  tell_changes(before, answered, code);
  for (const Action& action : actions.list()) carry_out(action);
  to_.lines.permit_belt(cycle_.status().belt_may_move());
  to_.plc.publish(registers(now_us), answer);
  keep_books(before, answered, code);
}

cycle::CycleInputs Controller::gather(std::int64_t now_us, const plc::PlcView& plc) {
  const LineLevels lines = to_.lines.read();
  cycle::CycleInputs in;
  in.now_us = now_us;
  in.device_code = to_.vision.device_code();
  if (!lines.known && in.device_code == ResultCode::kOk) in.device_code = lines.unknown_because;
  in.emergency_stop = lines.known && lines.emergency_stop;  // unknown lines are the lost device's fault, not a button's
  in.line_belt_stopped = lines.known && lines.belt_stopped;
  in.register_belt_stopped = plc.belt_stopped;
  in.robot_clear = plc.robot_clear;
  in.plc_silent = plc.heard && now_us - plc.heartbeat_changed_us > plc_timeout_us_;
  in.model_code = to_.models.code();
  in.model_changed = to_.models.take_changed();
  in.capture_time_us = to_.models.capture_time_us();
  in.workers_idle = to_.vision.idle() && to_.models.idle();
  in.capture = to_.vision.take_capture_outcome();
  in.locate = to_.vision.take_locate_outcome();
  if (plc.command) {
    in.command = plc.command->command;
    in.command_argument = plc.command->argument;
    in.recipe_known = to_.models.knows_recipe(plc.command->argument);
  }
  return in;
}

void Controller::carry_out(const Action& action) {
  switch (action.kind) {
    case ActionKind::kStartCapture:
      return to_.vision.start_capture(action.number);
    case ActionKind::kAbortCapture:
      return to_.vision.abort_capture(action.code);
    case ActionKind::kStartProcessing:
      return to_.vision.start_processing(action.number);
    case ActionKind::kOfferPart:
      return make_offer(action);
    case ActionKind::kRevokeOffer:
      offer_ = {};
      if (action.code != ResultCode::kOk) to_.log.code(LogLevel::kWarning, "offer revoked", action.code);
      return;
    case ActionKind::kSwitchRecipe:
      return to_.models.select_recipe(action.number);
    case ActionKind::kAnswerCommand:
      return;  // goes out with the registers
  }
}

void Controller::make_offer(const Action& action) {
  const LocatedPart& part = parts_[static_cast<std::size_t>(action.part)];
  const OfferFrame frame = to_.models.offer_frame();
  const auto T_offer_part = frame.T_offer_camera * part.T_camera_part;
  offer_ = {};
  offer_.sequence = action.number;
  offer_.part_number = static_cast<std::uint16_t>(part.template_index + 1);
  offer_.pose_kind = part.status == PoseStatus::kVerified ? 1 : 2;
  offer_.pose_frame = static_cast<std::uint16_t>(frame.frame);
  offer_.part = plc::register_pose(T_offer_part);
  offer_.score = static_cast<float>(part.score);
  offer_.grasp_number = static_cast<std::uint16_t>(part.grasp_index + 1);
  if (const Grasp* grasp = to_.models.grasp(part.template_index, part.grasp_index)) {
    offer_.grasp = plc::register_pose(T_offer_part * grasp->T_part_gripper);
    offer_.grasp_opening_mm = static_cast<float>(grasp->opening_mm);
  }
  const Vec3& at = T_offer_part.translation_mm;
  to_.log.write(LogLevel::kInfo, "offer %u: part %u at (%.1f, %.1f, %.1f) mm, score %.2f%s; %d left in this view",
                action.number, offer_.part_number, at.x(), at.y(), at.z(), part.score,
                part.touches_neighbour ? ", touches another" : "", cycle_.status().parts_left);
}

void Controller::refuse_grasp(int offered_part) {
  if (offered_part < 0 || static_cast<std::size_t>(offered_part) >= parts_.size()) return;
  const LocatedPart& part = parts_[static_cast<std::size_t>(offered_part)];
  const Grasp* grasp = to_.models.grasp(part.template_index, part.grasp_index);
  if (grasp != nullptr) to_.refused.add(part.T_camera_part * grasp->T_part_gripper);
}

void Controller::keep_books(const cycle::CycleStatus& before, std::uint16_t answered_command, ResultCode answer) {
  const cycle::CycleStatus& after = cycle_.status();
  if (after.cycle != before.cycle) {
    to_.book.add_cycle();
    to_.refused.clear();  // the belt has moved on
  }
  if (after.offer_sequence != before.offer_sequence) to_.book.add_offer();
  if (answer == ResultCode::kOk && answered_command == static_cast<std::uint16_t>(PlcCommand::kPickDone)) {
    to_.book.add_answer(true);
  }
  if (answer == ResultCode::kOk && answered_command == static_cast<std::uint16_t>(PlcCommand::kPickFailed)) {
    to_.book.add_answer(false);
    refuse_grasp(before.offered_part);
  }
  if (after.state == before.state) return;
  if (after.state == CellState::kFault) to_.book.add_fault(after.fault_code);
  if (after.state == CellState::kBeltReleased) to_.book.add_release();
}

void Controller::tell_changes(const cycle::CycleStatus& before, std::uint16_t answered_command, ResultCode answer) {
  const cycle::CycleStatus& after = cycle_.status();
  if (answered_command != 0 && answer != ResultCode::kOk) {
    char what[64];
    std::snprintf(what, sizeof what, "command %u (%s) refused", answered_command, command_name(answered_command));
    to_.log.code(LogLevel::kWarning, what, answer);
  }
  if (after.state == before.state) {
    if (after.last_code != before.last_code && after.state == CellState::kStarting) {
      to_.log.code(LogLevel::kWarning, "not ready", after.last_code);
    }
    return;
  }
  if (after.state == CellState::kFault)
    return to_.log.code(LogLevel::kFault, state_name(before.state), after.fault_code);
  to_.log.write(LogLevel::kInfo, "%s -> %s (cycle %u, capture %u)", state_name(before.state), state_name(after.state),
                after.cycle, after.capture);
}

plc::ApplianceRegisters Controller::registers(std::int64_t now_us) const {
  const cycle::CycleStatus& status = cycle_.status();
  plc::ApplianceRegisters out;
  out.heartbeat = static_cast<std::uint16_t>(now_us / kHeartbeat_us);
  out.state = status.state;
  out.status_bits = status.bits();
  out.fault_code = status.fault_code;
  out.last_code = status.last_code;
  out.recipe = to_.models.active_recipe();
  out.cycle = status.cycle;
  out.capture = status.capture;
  out.parts_left = static_cast<std::uint16_t>(status.parts_left);
  out.withheld = static_cast<std::uint16_t>(status.withheld);
  out.withheld_code = status.withheld_code;
  out.offer = offer_;
  return out;
}

}  // namespace beltpick::app
