#include "cycle/cycle.hpp"

#include <cstdlib>

namespace beltpick::cycle {

void Actions::add(const Action& action) {
  // A step takes at most one transition an event; running out is a bug in the table.
  if (static_cast<std::size_t>(count_) == list_.size()) std::abort();
  list_[count_++] = action;
}

std::uint16_t CycleStatus::bits() const {
  switch (state) {
    case CellState::kStarting:
      return 0;
    case CellState::kIdle:
      return kStatusReady;
    case CellState::kSettling:
      return kStatusCaptureWanted;
    case CellState::kCapturing:
      return kStatusCapturing;
    case CellState::kProcessing:
      return kStatusProcessing;
    case CellState::kOffering:
      return kStatusPoseValid;
    case CellState::kBeltReleased:
      return kStatusReady | kStatusBeltMayMove;
    case CellState::kFault:
      return kStatusFault;
  }
  return kStatusFault;
}

Cycle::Cycle(const CycleConfig& config)
    : config_(config), belt_(config.rest), next_sequence_(config.first_offer_sequence) {}

Actions Cycle::step(const CycleInputs& inputs) {
  actions_ = Actions{};
  now_us_ = inputs.now_us;
  belt_.sample(inputs.now_us, inputs.line_belt_stopped, inputs.register_belt_stopped, inputs.robot_clear);
  safety_events(inputs);
  report_events(inputs);
  timer_events(inputs);
  command_events(inputs);
  return actions_;
}

void Cycle::safety_events(const CycleInputs& in) {
  if (in.device_code == ResultCode::kOk) apply(CycleEvent::kReady, ResultCode::kRestarted);
  if (in.emergency_stop) apply(CycleEvent::kEmergencyStop, ResultCode::kEmergencyStop);
  if (in.device_code != ResultCode::kOk) {
    apply(CycleEvent::kDeviceLost, in.device_code);
    if (status_.state == CellState::kStarting) status_.last_code = in.device_code;
  }
  if (in.plc_silent) apply(CycleEvent::kPlcSilent, ResultCode::kPlcSilent);
  const ResultCode moved =
      status_.state == CellState::kOffering ? ResultCode::kBeltMovedDuringOffer : ResultCode::kBeltMovedDuringCapture;
  if (belt_.moving()) apply(CycleEvent::kBeltMoving, moved);
  if (!belt_.held()) apply(CycleEvent::kBeltNotHeld, moved);
  if (belt_.disagree_too_long()) apply(CycleEvent::kSignalsDisagree, ResultCode::kSignalsDisagree);
  if (!in.robot_clear) apply(CycleEvent::kRobotInView, ResultCode::kRobotInView);
  if (in.model_changed) apply(CycleEvent::kModelChanged, ResultCode::kModelChanged);
}

void Cycle::report_events(const CycleInputs& in) {
  if (in.capture.ended && in.capture.capture == status_.capture) {
    apply(in.capture.code == ResultCode::kOk ? CycleEvent::kCaptureDone : CycleEvent::kCaptureFailed, in.capture.code);
  }
  if (!in.locate.ended || in.locate.capture != status_.capture || status_.state != CellState::kProcessing) return;
  if (in.locate.code != ResultCode::kOk) {
    apply(CycleEvent::kLocateFailed, in.locate.code);
    return;
  }
  plan_.load(in.locate.parts, in.locate.withheld);
  status_.withheld = plan_.not_pickable();
  status_.withheld_code = in.locate.withheld > 0 ? in.locate.withheld_code : plan_.without_grasp_code();
  apply(plan_.next() >= 0 ? CycleEvent::kPartsFound : CycleEvent::kNothingPickable, ResultCode::kOk);
}

void Cycle::timer_events(const CycleInputs& in) {
  const std::int64_t in_state_us = now_us_ - entered_us_;
  switch (status_.state) {
    case CellState::kSettling:
      if (!belt_.settled() || !in.workers_idle) break;
      apply(in.model_code == ResultCode::kOk ? CycleEvent::kSettled : CycleEvent::kModelUnusable, in.model_code);
      break;
    case CellState::kCapturing:
      if (in_state_us > config_.capture_timeout_us + in.capture_time_us) {
        apply(CycleEvent::kCaptureTimeout, ResultCode::kCaptureTimeout);
      }
      break;
    case CellState::kProcessing:
      if (in_state_us > config_.processing_timeout_us) {
        apply(CycleEvent::kProcessingTimeout, ResultCode::kProcessingTimeout);
      }
      break;
    case CellState::kOffering:
      if (now_us_ - offered_us_ > config_.max_age_us) apply(CycleEvent::kOfferExpired, ResultCode::kOfferExpired);
      break;
    default:
      break;
  }
}

void Cycle::command_events(const CycleInputs& in) {
  const auto command = static_cast<PlcCommand>(in.command);
  const auto try_event = [&](CycleEvent event, ResultCode refusal, ResultCode code, std::uint16_t number = 0) {
    if (refusal == ResultCode::kOk && apply(event, code, number) == Transition::Kind::kRefuse) {
      refusal = ResultCode::kCommandNotAllowed;
    }
    answer(in.command, refusal);
  };
  switch (command) {
    case PlcCommand::kNone:
      return;
    case PlcCommand::kStartCycle:
      return try_event(CycleEvent::kStart, start_refusal(in), ResultCode::kOk);
    case PlcCommand::kPickDone:
    case PlcCommand::kPickFailed:
    case PlcCommand::kSkipPart:
      return answer_for_offer(in, command);
    case PlcCommand::kEndCycle:
      return try_event(CycleEvent::kEnd, ResultCode::kOk, ResultCode::kOk);
    case PlcCommand::kClearFault: {
      const bool faulted = status_.state == CellState::kFault;
      return try_event(CycleEvent::kClearFault, faulted ? clear_refusal(in) : ResultCode::kOk, ResultCode::kOk);
    }
    case PlcCommand::kSelectRecipe:
      return try_event(CycleEvent::kSelectRecipe, in.recipe_known ? ResultCode::kOk : ResultCode::kRecipeUnknown,
                       ResultCode::kModelChanged, in.command_argument);
  }
  answer(in.command, ResultCode::kCommandUnknown);
}

// A pick done, failed or a part skipped: only for the offer that stands.
void Cycle::answer_for_offer(const CycleInputs& in, PlcCommand command) {
  if (status_.state != CellState::kOffering || in.command_argument != status_.offer_sequence) {
    return answer(in.command, ResultCode::kCommandNotAllowed);
  }
  if (command == PlcCommand::kPickFailed) {
    const bool too_often = ++failed_picks_ >= config_.max_failed_picks;
    apply(too_often ? CycleEvent::kPickFailedTooOften : CycleEvent::kPickFailed, ResultCode::kPickFailed);
    return answer(in.command, ResultCode::kOk);
  }
  if (command == PlcCommand::kPickDone) {
    failed_picks_ = 0;
    plan_.picked(status_.offered_part);
  } else {
    plan_.skipped(status_.offered_part);
  }
  apply(after_offer(), ResultCode::kOk);
  answer(in.command, ResultCode::kOk);
}

CycleEvent Cycle::after_offer() {
  if (plan_.next() >= 0) return CycleEvent::kOfferNext;
  return plan_.capture_again() ? CycleEvent::kCaptureAgain : CycleEvent::kNothingLeft;
}

// A belt that only one of the signals calls stopped is given the time to agree; one that both call moving is not.
ResultCode Cycle::start_refusal(const CycleInputs& in) const {
  const bool may_start = status_.state == CellState::kIdle || status_.state == CellState::kBeltReleased;
  if (!may_start || belt_.moving()) return ResultCode::kCommandNotAllowed;
  return in.model_code;
}

// A fault is not cleared while its cause stands.
ResultCode Cycle::clear_refusal(const CycleInputs& in) {
  if (in.emergency_stop) return ResultCode::kEmergencyStop;
  if (in.device_code != ResultCode::kOk) return in.device_code;
  return in.plc_silent ? ResultCode::kPlcSilent : ResultCode::kOk;
}

Transition::Kind Cycle::apply(CycleEvent event, ResultCode code, std::uint16_t number) {
  const Transition& to = transition(status_.state, event);
  if (to.kind != Transition::Kind::kGo) return to.kind;
  const auto has = [&](Effect effect) { return (to.effects & effect) != 0; };

  if (has(kEffectAbortCapture)) actions_.add({ActionKind::kAbortCapture, code, status_.capture});
  if (has(kEffectRevokeOffer)) end_offer(code);
  if (has(kEffectRetireOffer)) end_offer(ResultCode::kOk);
  if (has(kEffectLatchFault)) status_.fault_code = status_.last_code = code;
  if (has(kEffectClearFault)) status_.fault_code = status_.last_code = ResultCode::kOk;
  if (has(kEffectNote)) status_.last_code = code;
  if (has(kEffectSwitchRecipe)) actions_.add({ActionKind::kSwitchRecipe, ResultCode::kOk, number});
  if (has(kEffectBeginCycle)) {
    ++status_.cycle;
    failed_picks_ = 0;
    status_.last_code = ResultCode::kOk;
  }
  if (to.next != status_.state) enter(to.next);
  if (has(kEffectStartCapture)) actions_.add({ActionKind::kStartCapture, ResultCode::kOk, ++status_.capture});
  if (has(kEffectStartProcessing)) actions_.add({ActionKind::kStartProcessing, ResultCode::kOk, status_.capture});
  if (has(kEffectOffer)) make_offer();
  status_.parts_left = status_.state == CellState::kOffering ? plan_.parts_left() : 0;
  return to.kind;
}

void Cycle::enter(CellState next) {
  status_.state = next;
  entered_us_ = now_us_;
  if (next == CellState::kSettling) {
    belt_.restart(now_us_);
    status_.withheld = 0;
    status_.withheld_code = ResultCode::kOk;
  }
}

void Cycle::end_offer(ResultCode code) {
  actions_.add({ActionKind::kRevokeOffer, code, status_.offer_sequence, status_.offered_part});
  status_.offered_part = -1;
}

void Cycle::make_offer() {
  status_.offered_part = plan_.next();
  status_.offer_sequence = next_sequence_;
  // 0 stays "no offer" for a PLC that clears its argument.
  next_sequence_ = next_sequence_ == 0xFFFF ? 1 : static_cast<std::uint16_t>(next_sequence_ + 1);
  offered_us_ = now_us_;
  actions_.add({ActionKind::kOfferPart, ResultCode::kOk, status_.offer_sequence, status_.offered_part});
}

void Cycle::answer(std::uint16_t command, ResultCode code) {
  if (code != ResultCode::kOk) status_.last_code = code;
  actions_.add({ActionKind::kAnswerCommand, code, command});
}

}  // namespace beltpick::cycle
