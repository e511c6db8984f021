#include "virtual_cell/world/plc_program.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "base/clock.hpp"

namespace beltpick::virtual_cell {
namespace {

using namespace std::chrono_literals;
constexpr auto kScan = 5ms;
constexpr int kExposuresBeforeFault = 4;  // the capture must be well under way
constexpr auto kBeltJerk = 300ms;

void scan_pause() { std::this_thread::sleep_for(kScan); }

std::uint16_t fault_code(const ApplianceRegisters& seen) { return seen.at(register_address("fault_code")); }
std::uint16_t last_code(const ApplianceRegisters& seen) { return seen.at(register_address("last_code")); }

}  // namespace

PlcProgram::PlcProgram(PlcLink& link, Plant& plant, FaultPlan plan, PlcProgramOptions options,
                       const std::atomic<bool>& stop)
    : link_(link), plant_(plant), plan_(std::move(plan)), options_(std::move(options)), stop_(stop) {}

CellReport PlcProgram::run() {
  if (begin()) {
    while (release_belt() && hold_belt(false)) {
      const bool more = plant_.bring_next_parts();
      if (!hold_belt(true)) break;
      if (!more) {
        report_.finished = true;
        break;
      }
      if (!run_view()) break;
    }
  }
  (void)write_status();
  return std::move(report_);
}

bool PlcProgram::begin() {
  if (!hold_belt(true)) return false;
  const Stopwatch waiting;
  for (;;) {
    const auto seen = look();
    if (!seen) return false;
    if (seen->state() == CellState::kFault && !recover()) return false;
    if (seen->has(kStatusReady)) break;
    if (waiting.elapsed_ms() > options_.answer_timeout_ms) return give_up("the appliance does not become ready");
    scan_pause();
  }
  if (options_.recipe == 0) return true;
  const auto result = command(PlcCommand::kSelectRecipe, options_.recipe);
  return (result && *result == ResultCode::kOk) || give_up("the appliance refuses the recipe");
}

bool PlcProgram::release_belt() {
  const auto seen = look();
  if (!seen) return false;
  if (seen->has(kStatusBeltMayMove)) return true;
  if (seen->state() == CellState::kFault && !recover()) return false;
  if (!command(PlcCommand::kEndCycle)) return false;
  const Stopwatch waiting;
  while (waiting.elapsed_ms() < options_.answer_timeout_ms) {
    const auto after = look();
    if (!after) return false;
    if (after->has(kStatusBeltMayMove)) return true;
    scan_pause();
  }
  return give_up("the appliance does not release the belt");
}

bool PlcProgram::run_view() {
  ViewRecord view;
  view.view = static_cast<int>(report_.views.size());
  view.parts = plant_.parts_in_view();
  report_.parts += view.parts;
  if (options_.on_view_begin) options_.on_view_begin(view.view);
  const Stopwatch watch;
  staged_ = false;
  captures_before_.reset();
  fault_.reset();
  if (const auto fault = plan_.for_cycle(view.view)) fault_ = FaultRecord{*fault, view.view, {}, false, false};
  ViewEnd end = ViewEnd::kFaulted;
  for (int attempt = 0; attempt <= options_.max_restarts && end == ViewEnd::kFaulted; ++attempt) {
    end = run_cycle(view);
    if (end == ViewEnd::kFaulted && !recover()) end = ViewEnd::kStopped;
  }
  view.left = plant_.parts_in_view();
  view.total_ms = watch.elapsed_ms();
  report_.tray += view.left;
  report_.views.push_back(view);
  if (options_.on_view_end) options_.on_view_end(view);
  close_fault(end == ViewEnd::kReleased);
  return end != ViewEnd::kStopped;
}

PlcProgram::ViewEnd PlcProgram::run_cycle(ViewRecord& view) {
  stage_before_start();
  const auto before = look();
  if (!before) return ViewEnd::kStopped;
  if (!captures_before_) captures_before_ = before->at(register_address("capture"));
  last_code_at_start_ = last_code(*before);
  exposures_at_start_ = plant_.exposures();
  const Stopwatch watch;
  const auto started = command(PlcCommand::kStartCycle);
  if (!started) return ViewEnd::kStopped;
  if (*started != ResultCode::kOk) note_code(static_cast<std::uint16_t>(*started));
  while (watch.elapsed_ms() < 4.0 * options_.answer_timeout_ms) {
    const auto seen = look();
    if (!seen) return ViewEnd::kStopped;
    view.captures = static_cast<std::uint16_t>(seen->at(register_address("capture")) - *captures_before_);
    if (last_code(*seen) != last_code_at_start_) note_code(last_code(*seen));
    if (seen->state() == CellState::kFault) return ViewEnd::kFaulted;
    if (seen->state() == CellState::kIdle) return ViewEnd::kFaulted;
    if (seen->state() == CellState::kBeltReleased) {
      view.withheld = seen->at(register_address("withheld"));
      view.withheld_code = seen->at(register_address("withheld_code"));
      return ViewEnd::kReleased;
    }
    stage_while_capturing(*seen);
    if (seen->has(kStatusPoseValid)) {
      if (view.first_pose_ms == 0.0) view.first_pose_ms = watch.elapsed_ms();
      if (!serve_offer(*seen, view)) return ViewEnd::kStopped;
    }
    scan_pause();
  }
  give_up("a cycle does not come to its end");
  return ViewEnd::kStopped;
}

bool PlcProgram::serve_offer(const ApplianceRegisters& seen, ViewRecord& view) {
  const Offer offer = offer_from(seen);
  if (!offer.whole || offer.sequence == served_sequence_) return true;
  served_sequence_ = offer.sequence;
  if (stage_at_offer(seen)) return true;
  if (!show_robot_clear(false)) return false;
  const PickResult result = plant_.pick(offer);
  const PickOutcome outcome = result.outcome;
  report_.picks.push_back({view.view, result});
  if (!show_robot_clear(true)) return false;
  if (outcome == PickOutcome::kCrashed) ++report_.crashes;
  if (outcome == PickOutcome::kBlocked) ++report_.blocked;
  if (outcome == PickOutcome::kPicked) {
    ++report_.picked;
    ++view.picked;
  }
  PlcCommand answer = PlcCommand::kPickDone;
  if (outcome != PickOutcome::kPicked) {
    // Once more after a new look; then the part travels on rather than hold the belt up.
    answer = view.failed_picks == 0 ? PlcCommand::kPickFailed : PlcCommand::kSkipPart;
    ++view.failed_picks;
  }
  return command(answer, offer.sequence).has_value();
}

// After a fault: its cause is taken away, the code noted, the fault cleared.
bool PlcProgram::recover() {
  const Stopwatch waiting;
  undo_fault();
  while (waiting.elapsed_ms() < options_.answer_timeout_ms) {
    const auto seen = look();
    if (!seen) return false;
    if (seen->state() == CellState::kIdle || seen->state() == CellState::kBeltReleased) return true;
    if (seen->state() == CellState::kFault) note_code(fault_code(*seen));
    if (!command(PlcCommand::kClearFault)) return false;
    std::this_thread::sleep_for(100ms);
  }
  return give_up("a fault cannot be cleared");
}

void PlcProgram::stage_before_start() {
  if (!fault_ || staged_ || fault_entry(fault_->fault).by != FaultBy::kDeviceBeforeStart) return;
  plant_.break_device(fault_->fault);
  staged_ = true;
}

void PlcProgram::stage_while_capturing(const ApplianceRegisters& seen) {
  if (!fault_ || staged_ || !seen.has(kStatusCapturing)) return;
  if (plant_.exposures() < exposures_at_start_ + kExposuresBeforeFault) return;
  staged_ = true;
  if (fault_entry(fault_->fault).by == FaultBy::kDeviceWhileCapturing) {
    plant_.break_device(fault_->fault);
  } else if (fault_->fault == CellFault::kBeltMovesCapture) {
    (void)hold_belt(false);
  } else if (fault_->fault == CellFault::kRobotInView) {
    (void)show_robot_clear(false);
  } else if (fault_->fault == CellFault::kEmergencyStop) {
    plant_.set_emergency_stop_line(true);
  } else {
    staged_ = false;  // its time comes later
  }
}

// True when the fault takes the place of the pick.
bool PlcProgram::stage_at_offer(const ApplianceRegisters& seen) {
  if (!fault_ || staged_) return false;
  switch (fault_->fault) {
    case CellFault::kBeltMovesOffer:
      (void)hold_belt(false);
      std::this_thread::sleep_for(kBeltJerk);
      break;
    case CellFault::kPlcSilent:
      link_.set_silent(true);
      break;
    case CellFault::kFailedPick:
      (void)show_robot_clear(false);
      plant_.miss();
      (void)show_robot_clear(true);
      (void)command(PlcCommand::kPickFailed, offer_from(seen).sequence);
      break;
    default:
      return false;
  }
  staged_ = true;
  return true;
}

void PlcProgram::undo_fault() {
  if (!staged_) return;
  link_.set_silent(false);
  plant_.set_emergency_stop_line(false);
  plant_.mend_devices();
  (void)show_robot_clear(true);
  (void)hold_belt(true);
}

void PlcProgram::close_fault(bool recovered) {
  if (!fault_) return;
  undo_fault();
  if (staged_) {
    const CellFaultEntry& entry = fault_entry(fault_->fault);
    const auto told = [this](ResultCode code) {
      return std::find(fault_->codes.begin(), fault_->codes.end(), static_cast<std::uint16_t>(code)) !=
             fault_->codes.end();
    };
    fault_->answered = entry.expected == ResultCode::kOk
                           ? fault_->codes.empty()
                           : told(entry.expected) || (entry.or_else && told(*entry.or_else));
    fault_->recovered = recovered;
    report_.faults.push_back(*fault_);
  }
  fault_.reset();
}

std::optional<ApplianceRegisters> PlcProgram::look() {
  if (stop_) {
    give_up("stopped");
    return std::nullopt;
  }
  const auto seen = link_.read();
  if (!seen) {
    give_up(std::string(seen.error().text()));
    return std::nullopt;
  }
  const bool fault = seen->state() == CellState::kFault;
  const bool pose = seen->has(kStatusPoseValid);
  const bool belt_free = seen->has(kStatusBeltMayMove);
  if ((fault && (pose || belt_free)) || (pose && belt_free)) ++report_.unsafe;
  return *seen;
}

std::optional<ResultCode> PlcProgram::command(PlcCommand command, std::uint16_t argument) {
  ApplianceRegisters seen;
  if (!link_.write_command(command, argument) || !await_echo(command, seen)) {
    give_up("a command is not answered");
    return std::nullopt;
  }
  const auto result = static_cast<ResultCode>(seen.at(register_address("command_result")));
  if (!link_.write_command(PlcCommand::kNone, 0) || !await_echo(PlcCommand::kNone, seen)) {
    give_up("a command's echo is not cleared");
    return std::nullopt;
  }
  return result;
}

bool PlcProgram::await_echo(PlcCommand command, ApplianceRegisters& seen) {
  const Stopwatch waiting;
  while (waiting.elapsed_ms() < options_.answer_timeout_ms) {
    const auto now = look();
    if (!now) return false;
    seen = *now;
    if (seen.at(register_address("command_echo")) == static_cast<std::uint16_t>(command)) return true;
    scan_pause();
  }
  return false;
}

bool PlcProgram::hold_belt(bool stopped) {
  belt_stopped_ = stopped;
  plant_.set_belt_stopped_line(stopped);
  return write_status();
}

bool PlcProgram::show_robot_clear(bool clear) {
  robot_clear_ = clear;
  return write_status();
}

bool PlcProgram::write_status() {
  const auto written = link_.write_status(
      static_cast<std::uint16_t>((belt_stopped_ ? kPlcBeltStopped : 0) | (robot_clear_ ? kPlcRobotClear : 0)));
  return written.has_value() || give_up(std::string(written.error().text()));
}

bool PlcProgram::give_up(const std::string& why) {
  if (report_.stopped_by.empty()) report_.stopped_by = why;
  return false;
}

void PlcProgram::note_code(std::uint16_t code) {
  if (!fault_ || !staged_ || code == 0) return;
  if (fault_->codes.empty() || fault_->codes.back() != code) fault_->codes.push_back(code);
}

}  // namespace beltpick::virtual_cell
