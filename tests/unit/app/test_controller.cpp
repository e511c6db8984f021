// The controller between a PLC's registers and stand-ins of the hardware.
#include <bit>
#include <catch2/catch.hpp>

#include "app/controller.hpp"
#include "stand_ins.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

struct Bench {
  StandInVision vision;
  StandInLines lines;
  StandInModels models;
  plc::PlcExchange exchange{plc::WordOrder::kHighFirst};
  Log log;
  RunBook book;
  RefusedGrasps refused;
  cycle::CycleConfig config;
  Controller controller{config, 2'000'000, {vision, lines, models, exchange, log, book, refused}};
  std::array<std::uint16_t, kHoldingRegisters> holding{};
  std::array<std::uint16_t, kInputRegisters> inputs{};
  std::int64_t now_us = 5'000'000;

  Bench() { holding[2] = kPlcBeltStopped | kPlcRobotClear; }

  void write(std::uint16_t command = 0, std::uint16_t argument = 0) {
    holding[0] = command;
    holding[1] = argument;
    ++holding[3];
    exchange.holding_written(holding, now_us);
  }
  void step(std::int64_t later_us = 2000) {
    now_us += later_us;
    controller.step(now_us);
    exchange.copy_inputs(inputs);
  }
  std::uint16_t command(PlcCommand number, std::uint16_t argument = 0) {
    write(static_cast<std::uint16_t>(number), argument);
    step();
    CHECK(inputs[3] == static_cast<std::uint16_t>(number));
    const std::uint16_t result = inputs[4];
    write();
    step();
    CHECK(inputs[3] == 0);
    return result;
  }
  [[nodiscard]] CellState state() const { return static_cast<CellState>(inputs[1]); }
  [[nodiscard]] float number(std::uint16_t address) const {
    return std::bit_cast<float>((static_cast<std::uint32_t>(inputs[address]) << 16U) | inputs[address + 1U]);
  }
  void to_offer() {
    LocatedPart part;
    part.grasp_index = 0;
    part.T_camera_part.translation_mm = {10, 20, 700};
    vision.parts = {part};
    step();
    CHECK(command(PlcCommand::kStartCycle) == 0);
    step(config.rest.settle_us);
    CHECK(state() == CellState::kCapturing);
    vision.capture_ends();
    step();
    vision.locate_ends();
    step();
    CHECK(state() == CellState::kOffering);
  }
};

}  // namespace

TEST_CASE("a pose is offered in the robot's frame with its grasp, and taken back when answered", "[controller]") {
  Bench bench;
  bench.models.frame.frame = PoseFrame::kRobot;
  bench.models.frame.T_offer_camera.translation_mm = {1000, 0, -700};
  bench.models.only_grasp.T_part_gripper.translation_mm = {0, 0, 30};
  bench.models.only_grasp.opening_mm = 45;
  bench.to_offer();
  CHECK((bench.inputs[2] & kStatusPoseValid) != 0);
  CHECK(bench.inputs[20] != 0);
  CHECK(bench.inputs[20] == bench.inputs[57]);
  CHECK(bench.inputs[21] == 1);
  CHECK(bench.inputs[23] == 3);
  CHECK(bench.number(24) == 1010.0F);
  CHECK(bench.number(28) == 0.0F);
  CHECK(bench.number(30) == 1.0F);
  CHECK(bench.number(42) == 30.0F);
  CHECK(bench.number(52) == 45.0F);
  CHECK(bench.command(PlcCommand::kPickDone, bench.inputs[20]) == 0);
  CHECK(bench.state() == CellState::kBeltReleased);
  CHECK(bench.lines.may_move);
  CHECK((bench.inputs[2] & kStatusBeltMayMove) != 0);
  for (std::uint16_t address = 20; address < 58; ++address) CHECK(bench.inputs[address] == 0);
}

TEST_CASE("a grasp that failed is remembered until the next cycle", "[controller]") {
  Bench bench;
  bench.models.only_grasp.T_part_gripper.translation_mm = {0, 0, 30};
  bench.to_offer();
  std::array<RefusedGrasps::GripperPose, RefusedGrasps::kMost> poses;
  CHECK(bench.refused.copy(poses).empty());
  CHECK(bench.command(PlcCommand::kPickFailed, bench.inputs[20]) == 0);
  const auto refused = bench.refused.copy(poses);
  REQUIRE(refused.size() == 1);
  CHECK(refused.front().translation_mm == Vec3(10, 20, 730));
  bench.step(bench.config.rest.settle_us);
  bench.vision.capture_ends();
  bench.step();
  bench.vision.parts = {};
  bench.vision.locate_ends();
  bench.step();
  CHECK(bench.state() == CellState::kBeltReleased);
  CHECK(bench.refused.copy(poses).size() == 1);
  CHECK(bench.command(PlcCommand::kStartCycle) == 0);
  CHECK(bench.refused.copy(poses).empty());
}

TEST_CASE("the belt's line, its register and the robot end a capture with their codes", "[controller]") {
  struct Case {
    ResultCode code;
    void (*happens)(Bench&);
  };
  const Case cases[] = {
      {ResultCode::kBeltMovedDuringCapture, [](Bench& b) { b.lines.levels.belt_stopped = false; }},
      {ResultCode::kBeltMovedDuringCapture,
       [](Bench& b) {
         b.holding[2] = kPlcRobotClear;
         b.write();
       }},
      {ResultCode::kRobotInView,
       [](Bench& b) {
         b.holding[2] = kPlcBeltStopped;
         b.write();
       }},
      {ResultCode::kEmergencyStop, [](Bench& b) { b.lines.levels.emergency_stop = true; }},
      {ResultCode::kTriggerLost, [](Bench& b) { b.lines.levels = LineLevels{}; }},
      {ResultCode::kCameraLost, [](Bench& b) { b.vision.device = ResultCode::kCameraLost; }},
      {ResultCode::kPlcSilent, [](Bench& b) { b.now_us += 2'000'001; }},
  };
  for (const Case& with : cases) {
    CAPTURE(static_cast<int>(with.code));
    Bench bench;
    bench.step();
    bench.command(PlcCommand::kStartCycle);
    bench.step(bench.config.rest.settle_us);
    REQUIRE(bench.state() == CellState::kCapturing);
    with.happens(bench);
    bench.step();
    CHECK(bench.state() == CellState::kFault);
    CHECK(bench.inputs[5] == static_cast<std::uint16_t>(with.code));
    CHECK(bench.vision.aborted == 1);
    CHECK((bench.inputs[2] & (kStatusBeltMayMove | kStatusPoseValid)) == 0);

    bench.lines.levels = {true, true, false};
    bench.vision.device = ResultCode::kOk;
    bench.holding[2] = kPlcBeltStopped | kPlcRobotClear;
    CHECK(bench.command(PlcCommand::kClearFault) == 0);
    bench.to_offer();
  }
}

TEST_CASE("a PLC that was never heard is not silent; the heartbeat counts", "[controller]") {
  Bench bench;
  bench.step(60'000'000);
  CHECK(bench.state() == CellState::kIdle);
  const std::uint16_t heartbeat = bench.inputs[0];
  bench.step(1'000'000);
  CHECK(static_cast<std::uint16_t>(bench.inputs[0] - heartbeat) == 10);
}

TEST_CASE("a recipe is selected by number; a model swapped from outside takes the offer back", "[controller]") {
  Bench bench;
  bench.step();
  CHECK(bench.command(PlcCommand::kSelectRecipe, 2) == 0);
  CHECK(bench.inputs[7] == 2);
  CHECK(bench.command(PlcCommand::kSelectRecipe, 5) == static_cast<std::uint16_t>(ResultCode::kRecipeUnknown));
  bench.to_offer();
  bench.models.changed = true;
  bench.step();
  CHECK(bench.state() == CellState::kSettling);
  CHECK(bench.inputs[6] == static_cast<std::uint16_t>(ResultCode::kModelChanged));
  CHECK(bench.inputs[20] == 0);
}
