// Random walks: whatever comes in whatever order, the cell never does what the design forbids.
#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "cell_driver.hpp"

using namespace beltpick;
using namespace beltpick::cycle;

namespace {

// Follows the actions as the hardware and the PLC would see them.
struct Witness {
  bool capturing = false;
  bool offered = false;
  std::uint16_t offer = 0;
  int answers = 0;

  void follow(const CellDriver& cell) {
    answers = 0;
    for (const Action& action : cell.actions) {
      switch (action.kind) {
        case ActionKind::kStartCapture:
          REQUIRE_FALSE(capturing);
          REQUIRE_FALSE(offered);
          capturing = true;
          break;
        case ActionKind::kAbortCapture:
        case ActionKind::kStartProcessing:
          REQUIRE(capturing);
          capturing = false;
          break;
        case ActionKind::kOfferPart:
          REQUIRE_FALSE(offered);
          REQUIRE(action.number != offer);
          offered = true;
          offer = action.number;
          break;
        case ActionKind::kRevokeOffer:
          REQUIRE(offered);
          REQUIRE(action.number == offer);
          offered = false;
          break;
        case ActionKind::kAnswerCommand:
          ++answers;
          break;
        case ActionKind::kSwitchRecipe:
          REQUIRE_FALSE(offered);
          break;
      }
    }
    if (cell.state() != CellState::kCapturing) capturing = false;  // ended by its own failure
  }
};

void disturb(CellDriver& cell, Random& random) {
  auto& in = cell.in;
  const auto toggle = [&](bool& signal, bool good) {
    if (random.below(100) == 0)
      signal = !good;
    else if (random.below(8) == 0)
      signal = good;
  };
  toggle(in.emergency_stop, false);
  toggle(in.plc_silent, false);
  toggle(in.line_belt_stopped, true);
  toggle(in.register_belt_stopped, true);
  toggle(in.robot_clear, true);
  toggle(in.workers_idle, true);
  if (random.below(200) == 0)
    in.device_code = ResultCode::kTriggerLost;
  else if (random.below(8) == 0)
    in.device_code = ResultCode::kOk;
  in.model_changed = random.below(400) == 0;
  in.recipe_known = random.below(2) == 0;
  const auto stale = static_cast<std::uint16_t>(random.below(10) == 0 ? 1 : 0);
  if (random.below(6) == 0) {
    in.capture = {true, static_cast<std::uint16_t>(cell.status().capture - stale),
                  random.below(5) == 0 ? ResultCode::kFrameMissing : ResultCode::kOk};
  }
  if (random.below(6) == 0) {
    const bool processing = cell.state() == CellState::kProcessing;  // else an old report: its parts stay as they are
    if (processing) cell.parts.clear();
    for (std::uint32_t i = processing ? random.below(5) : 0; i > 0; --i)
      cell.add_part(random.below(2) == 0, random.below(5) == 0 ? -1 : 0);
    in.locate = {true,
                 static_cast<std::uint16_t>(cell.status().capture - stale),
                 random.below(9) == 0 ? ResultCode::kFrameBlack : ResultCode::kOk,
                 cell.parts,
                 static_cast<int>(random.below(3)),
                 ResultCode::kNoHypothesis};
  }
  if (random.below(3) == 0) {
    in.command = static_cast<std::uint16_t>(random.below(9));
    in.command_argument = random.below(4) == 0 ? 7 : cell.status().offer_sequence;
  }
}

}  // namespace

TEST_CASE("random walks keep the invariants of the design", "[walk]") {
  std::array<int, 8> visits{};
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CellDriver cell;
    cell.in.device_code = ResultCode::kCameraNotFound;
    Witness witness;
    Random random(seed);
    CAPTURE(seed);
    for (int i = 0; i < 5000; ++i) {
      disturb(cell, random);
      const CycleInputs before = cell.in;
      cell.step(static_cast<std::int64_t>(random.below(40'000)) + (random.below(500) == 0 ? 20'000'000 : 0));
      witness.follow(cell);
      const CycleStatus& status = cell.status();
      ++visits[static_cast<std::size_t>(status.state)];
      const bool held = before.line_belt_stopped && before.register_belt_stopped;

      REQUIRE(status.pose_valid() == witness.offered);
      REQUIRE((status.state == CellState::kCapturing) == witness.capturing);
      REQUIRE((witness.answers == 1) == (before.command != 0));
      REQUIRE_FALSE((status.pose_valid() && !held));
      REQUIRE_FALSE((status.state == CellState::kCapturing && !(held && before.robot_clear)));
      REQUIRE_FALSE((status.belt_may_move() && (status.pose_valid() || status.state == CellState::kFault)));
      if (before.emergency_stop || before.plc_silent || before.device_code != ResultCode::kOk) {
        REQUIRE((status.state == CellState::kFault || status.state == CellState::kStarting));
      }
      REQUIRE((status.state == CellState::kFault) == (status.fault_code != ResultCode::kOk));
      REQUIRE((status.offered_part >= 0) == witness.offered);
      if (witness.offered) {
        REQUIRE(cell.parts[status.offered_part].grasp_index >= 0);
      }
    }
  }
  for (const int count : visits) CHECK(count > 0);
}
