// The good cycle: from the start command to the released belt, picks, skips, new captures.
#include <catch2/catch.hpp>

#include "cell_driver.hpp"

using namespace beltpick;
using namespace beltpick::cycle;

TEST_CASE("a new cell is idle once its devices are there, keeps the belt and says that older offers are void",
          "[cycle]") {
  CellDriver cell;
  cell.in.device_code = ResultCode::kCameraNotFound;
  cell.step();
  CHECK(cell.state() == CellState::kStarting);
  CHECK(cell.status().last_code == ResultCode::kCameraNotFound);
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kCommandNotAllowed);
  cell.in.device_code = ResultCode::kOk;
  cell.step();
  CHECK(cell.state() == CellState::kIdle);
  CHECK(cell.status().last_code == ResultCode::kRestarted);
  CHECK(cell.status().bits() == kStatusReady);
}

TEST_CASE("every state can be brought about", "[cycle]") {
  for (const CellState wanted : kAllStates) {
    CellDriver cell;
    cell.bring_to(wanted);
    CHECK(cell.state() == wanted);
  }
}

TEST_CASE("a cycle: settle, capture, locate, offer, pick, release", "[cycle]") {
  CellDriver cell;
  cell.add_part();
  cell.bring_to(CellState::kIdle);
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kOk);
  CHECK(cell.status().bits() == kStatusCaptureWanted);
  cell.step();
  cell.step(cell.config.rest.settle_us - 1);
  CHECK(cell.state() == CellState::kSettling);
  cell.step(1);
  REQUIRE(cell.find(ActionKind::kStartCapture) != nullptr);
  CHECK(cell.status().bits() == kStatusCapturing);
  cell.capture_ended();
  REQUIRE(cell.find(ActionKind::kStartProcessing) != nullptr);
  CHECK(cell.find(ActionKind::kStartProcessing)->number == cell.status().capture);
  cell.locate_ended();
  REQUIRE(cell.find(ActionKind::kOfferPart) != nullptr);
  CHECK(cell.find(ActionKind::kOfferPart)->part == 0);
  CHECK(cell.status().parts_left == 1);
  CHECK(cell.status().bits() == kStatusPoseValid);
  CHECK(cell.answer_offer(PlcCommand::kPickDone) == ResultCode::kOk);
  CHECK(cell.state() == CellState::kBeltReleased);
  CHECK(cell.status().belt_may_move());
  CHECK(cell.status().cycle == 1);
}

TEST_CASE("nothing found releases the belt and tells what was withheld", "[cycle]") {
  CellDriver cell;
  cell.bring_to(CellState::kProcessing);
  cell.parts.clear();
  cell.locate_ended(ResultCode::kOk, 2, ResultCode::kCoverageTooLow);
  CHECK(cell.state() == CellState::kBeltReleased);
  CHECK(cell.status().withheld == 2);
  CHECK(cell.status().withheld_code == ResultCode::kCoverageTooLow);
}

TEST_CASE("parts that stand alone are offered one after the other from one capture", "[cycle]") {
  CellDriver cell;
  for (int i = 0; i < 3; ++i) cell.add_part();
  cell.bring_to(CellState::kOffering);
  const std::uint16_t first = cell.status().offer_sequence;
  for (int part = 1; part < 3; ++part) {
    cell.answer_offer(PlcCommand::kPickDone);
    CHECK(cell.state() == CellState::kOffering);
    CHECK(cell.find(ActionKind::kOfferPart)->part == part);
    CHECK(cell.status().offer_sequence == first + part);
    CHECK(cell.status().parts_left == 3 - part);
  }
  cell.answer_offer(PlcCommand::kPickDone);
  CHECK(cell.state() == CellState::kBeltReleased);
  CHECK(cell.status().capture == 1);
}

TEST_CASE("parts that stand alone are offered on, those that touch something are captured again", "[cycle]") {
  CellDriver cell;
  cell.add_part(false);
  cell.add_part(true);
  cell.add_part(false);
  cell.bring_to(CellState::kOffering);
  cell.answer_offer(PlcCommand::kPickDone);
  REQUIRE(cell.state() == CellState::kOffering);
  CHECK(cell.find(ActionKind::kOfferPart)->part == 2);
  cell.answer_offer(PlcCommand::kPickDone);
  CHECK(cell.state() == CellState::kSettling);
  CHECK((cell.status().bits() & kStatusCaptureWanted) != 0);
}

TEST_CASE("after a part that touched another nothing of the old view is offered", "[cycle]") {
  CellDriver cell;
  cell.add_part(true);
  cell.add_part(false);
  cell.bring_to(CellState::kOffering);
  cell.answer_offer(PlcCommand::kPickDone);
  CHECK(cell.state() == CellState::kSettling);
}

TEST_CASE("what was withheld is looked at again after a pick", "[cycle]") {
  CellDriver cell;
  cell.add_part();
  cell.bring_to(CellState::kProcessing);
  cell.locate_ended(ResultCode::kOk, 1);
  cell.answer_offer(PlcCommand::kPickDone);
  CHECK(cell.state() == CellState::kSettling);
}

TEST_CASE("a skipped part is left for the tray", "[cycle]") {
  CellDriver cell;
  cell.bring_to(CellState::kOffering);
  CHECK(cell.answer_offer(PlcCommand::kSkipPart) == ResultCode::kOk);
  CHECK(cell.state() == CellState::kBeltReleased);
}

TEST_CASE("a new capture waits until the robot is clear and the workers are idle", "[cycle]") {
  CellDriver cell;
  cell.bring_to(CellState::kSettling);
  cell.in.robot_clear = false;
  cell.step(10'000'000);
  CHECK(cell.state() == CellState::kSettling);
  cell.in.robot_clear = true;
  cell.in.workers_idle = false;
  cell.step();
  cell.step(cell.config.rest.settle_us);
  CHECK(cell.state() == CellState::kSettling);
  cell.in.workers_idle = true;
  cell.step();
  CHECK(cell.state() == CellState::kCapturing);
}

TEST_CASE("an answer with another offer's number is refused and the offer stands", "[cycle]") {
  CellDriver cell;
  cell.bring_to(CellState::kOffering);
  const auto other = static_cast<std::uint16_t>(cell.status().offer_sequence + 1);
  for (const auto answer : {PlcCommand::kPickDone, PlcCommand::kPickFailed, PlcCommand::kSkipPart}) {
    CHECK(cell.command(answer, other) == ResultCode::kCommandNotAllowed);
    CHECK(cell.state() == CellState::kOffering);
  }
}

TEST_CASE("offer numbers never are 0 and never repeat within a wrap", "[cycle]") {
  CycleConfig config;
  config.first_offer_sequence = 0xFFFF;
  CellDriver cell(config);
  cell.add_part();
  cell.add_part();
  cell.bring_to(CellState::kOffering);
  CHECK(cell.status().offer_sequence == 0xFFFF);
  cell.answer_offer(PlcCommand::kPickDone);
  CHECK(cell.status().offer_sequence == 1);
}

TEST_CASE("a recipe is switched between cycles and voids an offer", "[cycle]") {
  for (const auto state : {CellState::kIdle, CellState::kBeltReleased, CellState::kSettling, CellState::kOffering}) {
    CellDriver cell;
    cell.bring_to(state);
    CHECK(cell.command(PlcCommand::kSelectRecipe, 2) == ResultCode::kOk);
    REQUIRE(cell.find(ActionKind::kSwitchRecipe) != nullptr);
    CHECK(cell.find(ActionKind::kSwitchRecipe)->number == 2);
    CHECK((cell.find(ActionKind::kRevokeOffer) != nullptr) == (state == CellState::kOffering));
    CHECK_FALSE(cell.status().pose_valid());
  }
  CellDriver cell;
  cell.bring_to(CellState::kCapturing);
  CHECK(cell.command(PlcCommand::kSelectRecipe, 2) == ResultCode::kCommandNotAllowed);
  CellDriver other;
  other.bring_to(CellState::kIdle);
  other.in.recipe_known = false;
  CHECK(other.command(PlcCommand::kSelectRecipe, 9) == ResultCode::kRecipeUnknown);
}

TEST_CASE("a start is refused without a model, while the belt moves, and in the middle of a cycle", "[cycle]") {
  CellDriver cell;
  cell.bring_to(CellState::kIdle);
  cell.in.model_code = ResultCode::kTemplateTooLarge;
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kTemplateTooLarge);
  CHECK(cell.status().last_code == ResultCode::kTemplateTooLarge);
  cell.in.model_code = ResultCode::kOk;
  cell.in.line_belt_stopped = cell.in.register_belt_stopped = false;
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kCommandNotAllowed);
  cell.in.line_belt_stopped = cell.in.register_belt_stopped = true;
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kOk);
  CHECK(cell.command(PlcCommand::kStartCycle) == ResultCode::kCommandNotAllowed);
  CHECK(cell.command(static_cast<PlcCommand>(77)) == ResultCode::kCommandUnknown);
}
