// Everything that can go wrong: its own code, the safe state, the way back, and the next cycle works.
#include <catch2/catch.hpp>

#include <functional>

#include "cell_driver.hpp"

using namespace beltpick;
using namespace beltpick::cycle;

namespace {

void check_next_cycle_works(CellDriver& cell) {
  cell.in.emergency_stop = cell.in.plc_silent = false;
  cell.in.device_code = ResultCode::kOk;
  cell.in.line_belt_stopped = cell.in.register_belt_stopped = cell.in.robot_clear = true;
  CHECK(cell.command(PlcCommand::kClearFault) == ResultCode::kOk);
  CHECK(cell.status().fault_code == ResultCode::kOk);
  CHECK_FALSE(cell.status().belt_may_move());
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kOk);
  cell.step();
  cell.step(cell.config.rest.settle_us);
  cell.capture_ended();
  cell.locate_ended();
  CHECK(cell.state() == CellState::kOffering);
  cell.answer_offer(PlcCommand::kPickDone);
  CHECK(cell.state() == CellState::kBeltReleased);
}

struct Fault {
  CellState in_state;
  ResultCode code;
  std::function<void(CellDriver&)> happens;
};

const auto kStop = [](CellDriver& c) { c.in.emergency_stop = true; };
const auto kSilent = [](CellDriver& c) { c.in.plc_silent = true; };
const auto kLineLost = [](CellDriver& c) { c.in.line_belt_stopped = false; };
const auto kRegisterLost = [](CellDriver& c) { c.in.register_belt_stopped = false; };
const auto kBeltRuns = [](CellDriver& c) { c.in.line_belt_stopped = c.in.register_belt_stopped = false; };
const auto kRobot = [](CellDriver& c) { c.in.robot_clear = false; };
const auto kCamera = [](CellDriver& c) { c.in.device_code = ResultCode::kCameraLost; };

}  // namespace

TEST_CASE("a fault has its code, ends offer and capture, keeps the belt, latches, and the next cycle works",
          "[faults]") {
  const Fault faults[] = {
      {CellState::kSettling, ResultCode::kBeltMovedDuringCapture, kBeltRuns},
      {CellState::kCapturing, ResultCode::kBeltMovedDuringCapture, kLineLost},
      {CellState::kCapturing, ResultCode::kBeltMovedDuringCapture, kRegisterLost},
      {CellState::kProcessing, ResultCode::kBeltMovedDuringCapture, kLineLost},
      {CellState::kOffering, ResultCode::kBeltMovedDuringOffer, kLineLost},
      {CellState::kOffering, ResultCode::kBeltMovedDuringOffer, kRegisterLost},
      {CellState::kCapturing, ResultCode::kRobotInView, kRobot},
      {CellState::kIdle, ResultCode::kEmergencyStop, kStop},
      {CellState::kSettling, ResultCode::kEmergencyStop, kStop},
      {CellState::kCapturing, ResultCode::kEmergencyStop, kStop},
      {CellState::kProcessing, ResultCode::kEmergencyStop, kStop},
      {CellState::kOffering, ResultCode::kEmergencyStop, kStop},
      {CellState::kBeltReleased, ResultCode::kEmergencyStop, kStop},
      {CellState::kIdle, ResultCode::kPlcSilent, kSilent},
      {CellState::kOffering, ResultCode::kPlcSilent, kSilent},
      {CellState::kBeltReleased, ResultCode::kPlcSilent, kSilent},
      {CellState::kIdle, ResultCode::kCameraLost, kCamera},
      {CellState::kCapturing, ResultCode::kCameraLost, kCamera},
      {CellState::kOffering, ResultCode::kCameraLost, kCamera},
  };
  for (const Fault& fault : faults) {
    CAPTURE(static_cast<int>(fault.in_state), static_cast<int>(fault.code));
    CellDriver cell;
    cell.bring_to(fault.in_state);
    REQUIRE(cell.state() == fault.in_state);
    fault.happens(cell);
    cell.step();
    CHECK(cell.state() == CellState::kFault);
    CHECK(cell.status().fault_code == fault.code);
    CHECK(cell.status().last_code == fault.code);
    CHECK(cell.status().bits() == kStatusFault);
    CHECK((cell.find(ActionKind::kAbortCapture) != nullptr) == (fault.in_state == CellState::kCapturing));
    CHECK((cell.find(ActionKind::kRevokeOffer) != nullptr) == (fault.in_state == CellState::kOffering));
    check_next_cycle_works(cell);
  }
}

TEST_CASE("a capture or a locating that fails is a fault with its code", "[faults]") {
  for (const auto code : {ResultCode::kFrameMissing, ResultCode::kFrameIncomplete, ResultCode::kFrameWrongSize,
                          ResultCode::kCameraLost, ResultCode::kTriggerLost}) {
    CellDriver cell;
    cell.bring_to(CellState::kCapturing);
    cell.capture_ended(code);
    CHECK(cell.status().fault_code == code);
    check_next_cycle_works(cell);
  }
  for (const auto code : {ResultCode::kFrameBlack, ResultCode::kFrameDuplicated, ResultCode::kTooFewPoints}) {
    CellDriver cell;
    cell.bring_to(CellState::kProcessing);
    cell.locate_ended(code);
    CHECK(cell.status().fault_code == code);
    check_next_cycle_works(cell);
  }
}

TEST_CASE("a fault is not cleared while its cause stands, and keeps its first code", "[faults]") {
  CellDriver cell;
  cell.bring_to(CellState::kOffering);
  cell.in.emergency_stop = true;
  cell.step();
  cell.in.plc_silent = true;
  cell.step();
  CHECK(cell.status().fault_code == ResultCode::kEmergencyStop);
  CHECK(cell.command(PlcCommand::kClearFault) == ResultCode::kEmergencyStop);
  cell.in.emergency_stop = false;
  CHECK(cell.command(PlcCommand::kClearFault) == ResultCode::kPlcSilent);
  CHECK(cell.state() == CellState::kFault);
  check_next_cycle_works(cell);
}

TEST_CASE("captures and locating that do not end are ended", "[faults]") {
  CellDriver cell;
  cell.in.capture_time_us = 1'000'000;
  cell.bring_to(CellState::kCapturing);
  cell.step(cell.config.capture_timeout_us + cell.in.capture_time_us - 1);
  CHECK(cell.state() == CellState::kCapturing);
  cell.step(2);
  CHECK(cell.status().fault_code == ResultCode::kCaptureTimeout);
  CHECK(cell.find(ActionKind::kAbortCapture) != nullptr);
  CellDriver other;
  other.bring_to(CellState::kProcessing);
  other.step(other.config.processing_timeout_us + 1);
  CHECK(other.status().fault_code == ResultCode::kProcessingTimeout);
}

TEST_CASE("line and register may differ for a moment before they must agree", "[faults]") {
  CellDriver cell;
  cell.bring_to(CellState::kIdle);
  cell.in.line_belt_stopped = false;
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kOk);
  cell.step();
  cell.step(cell.config.rest.signals_agree_us - 1000);
  CHECK(cell.state() == CellState::kSettling);
  SECTION("they agree in time") {
    cell.in.line_belt_stopped = true;
    cell.step();
    cell.step(cell.config.rest.settle_us);
    CHECK(cell.state() == CellState::kCapturing);
  }
  SECTION("they do not") {
    cell.step(2000);
    CHECK(cell.status().fault_code == ResultCode::kSignalsDisagree);
    check_next_cycle_works(cell);
  }
}

TEST_CASE("a bounce of the line while settling starts the settle time anew", "[faults]") {
  CellDriver cell;
  cell.bring_to(CellState::kSettling);
  cell.step();
  cell.step(cell.config.rest.settle_us - 1000);
  cell.in.line_belt_stopped = false;
  cell.step(100);
  cell.in.line_belt_stopped = true;
  cell.step(100);
  cell.step(cell.config.rest.settle_us - 1000);
  CHECK(cell.state() == CellState::kSettling);
  cell.step(1000);
  CHECK(cell.state() == CellState::kCapturing);
}

TEST_CASE("a failed pick revokes and captures again; several in a row need a person", "[faults]") {
  CellDriver cell;
  cell.bring_to(CellState::kOffering);
  for (int attempt = 1; attempt < cell.config.max_failed_picks; ++attempt) {
    CHECK(cell.answer_offer(PlcCommand::kPickFailed) == ResultCode::kOk);
    REQUIRE(cell.find(ActionKind::kRevokeOffer) != nullptr);
    CHECK(cell.find(ActionKind::kRevokeOffer)->code == ResultCode::kPickFailed);
    CHECK(cell.state() == CellState::kSettling);
    CHECK(cell.status().last_code == ResultCode::kPickFailed);
    cell.step();
    cell.step(cell.config.rest.settle_us);
    cell.capture_ended();
    cell.locate_ended();
    REQUIRE(cell.state() == CellState::kOffering);
  }
  cell.answer_offer(PlcCommand::kPickFailed);
  CHECK(cell.status().fault_code == ResultCode::kPickFailed);
  check_next_cycle_works(cell);
}

TEST_CASE("an offer that nobody takes expires, is revoked and the view is captured again", "[faults]") {
  CellDriver cell;
  cell.bring_to(CellState::kOffering);
  const std::uint16_t sequence = cell.status().offer_sequence;
  cell.step(cell.config.max_age_us - 2000);
  CHECK(cell.state() == CellState::kOffering);
  cell.step(4000);
  CHECK(cell.state() == CellState::kSettling);
  CHECK(cell.status().last_code == ResultCode::kOfferExpired);
  CHECK(cell.command(PlcCommand::kPickDone, sequence) == ResultCode::kCommandNotAllowed);
}

TEST_CASE("a model swapped from outside voids what was seen; the cycle goes on with a new look", "[faults]") {
  for (const auto state : {CellState::kSettling, CellState::kCapturing, CellState::kProcessing, CellState::kOffering}) {
    CellDriver cell;
    cell.bring_to(state);
    cell.in.model_changed = true;
    cell.step();
    CHECK(cell.state() == CellState::kSettling);
    CHECK(cell.status().last_code == ResultCode::kModelChanged);
    CHECK((cell.find(ActionKind::kAbortCapture) != nullptr) == (state == CellState::kCapturing));
    CHECK((cell.find(ActionKind::kRevokeOffer) != nullptr) == (state == CellState::kOffering));
  }
}

TEST_CASE("with models that cannot be used any more nothing is captured; the cell waits for a start", "[faults]") {
  CellDriver cell;
  cell.bring_to(CellState::kOffering);
  cell.in.model_changed = true;
  cell.in.workers_idle = false;  // the halves of the model memory change places
  cell.step();
  cell.step();
  cell.step(5'000'000);
  CHECK(cell.state() == CellState::kSettling);
  cell.in.workers_idle = true;
  cell.in.model_code = ResultCode::kCalibrationMismatch;
  cell.step();
  CHECK(cell.state() == CellState::kIdle);
  CHECK(cell.status().last_code == ResultCode::kCalibrationMismatch);
  CHECK(cell.find(ActionKind::kStartCapture) == nullptr);
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kCalibrationMismatch);
}

TEST_CASE("the report of an aborted capture does not count for the next one", "[faults]") {
  CellDriver cell;
  cell.bring_to(CellState::kCapturing);
  const std::uint16_t aborted = cell.status().capture;
  CHECK(cell.command(PlcCommand::kEndCycle) == ResultCode::kOk);
  CHECK(cell.find(ActionKind::kAbortCapture) != nullptr);
  cell.command(PlcCommand::kStartCycle);
  cell.step();
  cell.step(cell.config.rest.settle_us);
  REQUIRE(cell.state() == CellState::kCapturing);
  cell.in.capture = {true, aborted, ResultCode::kOk};
  cell.step();
  CHECK(cell.state() == CellState::kCapturing);
}
