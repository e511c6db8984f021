// Whole captures against the virtual camera and the host board: what passes, and every fault with its code and its way
// back.
#include "rig.hpp"

using namespace rig;
using virtual_cell::gige::FrameFault;

TEST_CASE("twenty captures in a row, each with all frames in step", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  for (int i = 0; i < 20; ++i) {
    const ResultCode code = appliance.capture();
    INFO(i << ": " << appliance.text);
    REQUIRE(code == ResultCode::kOk);
    CHECK(appliance.taken == 17);
  }
  CHECK(cell.camera->edges_while_exposing() == 0);
}

TEST_CASE("lost packets are resent and cost nothing", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  cell.camera->set_packet_loss(0.05);
  for (int i = 0; i < 3; ++i) {
    const ResultCode code = appliance.capture();
    INFO(appliance.text);
    CHECK(code == ResultCode::kOk);
  }
  CHECK(cell.camera->counters().resent > 0);
}

TEST_CASE("a frame fault has its own code, and the next capture is good", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  REQUIRE(appliance.capture() == ResultCode::kOk);
  const auto [fault, code] = GENERATE(table<FrameFault, int>({{FrameFault::kLoseFrame, 100},
                                                              {FrameFault::kShortFrame, 101},
                                                              {FrameFault::kWrongSize, 102},
                                                              {FrameFault::kBlack, 103},
                                                              {FrameFault::kDuplicate, 104},
                                                              {FrameFault::kMissTrigger, 132}}));
  for (const int frame : {0, 5, 15}) {
    if (fault == FrameFault::kDuplicate && frame == 0) continue;
    cell.camera->inject(fault, frame);
    const ResultCode found = appliance.capture();
    INFO("frame " << frame << ": " << appliance.text);
    CHECK(static_cast<int>(found) == code);
    const bool named = appliance.text.find("frame " + std::to_string(frame)) != std::string::npos;
    CHECK(named);
    check_captures_well(appliance);
  }
}

TEST_CASE("a last frame that never arrives is missing", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  cell.camera->inject(FrameFault::kLoseFrame, 16);
  CHECK(appliance.capture() == ResultCode::kFrameMissing);
  CHECK(appliance.capture() == ResultCode::kOk);
}

TEST_CASE("stragglers of a failed capture are not taken for frames of the next", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  REQUIRE(appliance.capture() == ResultCode::kOk);
  cell.slow_frame = 5;  // comes long after the capture was given up
  CHECK(appliance.capture() == ResultCode::kFrameMissing);
  check_captures_well(appliance);
}

TEST_CASE("an exposure that nobody triggered between two captures is told once, by its name", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  REQUIRE(appliance.capture() == ResultCode::kOk);
  cell.camera->line_edge(true, monotonic_us());
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  cell.camera->line_edge(false, monotonic_us());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // for its image to arrive
  CHECK(appliance.capture() == ResultCode::kFrameExtra);
  check_captures_well(appliance);
}

TEST_CASE("a missed projector advance is a repeated pattern", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  cell.on_pulse = [&](int pulse) {
    if (pulse == 3) cell.board->drop_projector_advances(1);
  };
  CHECK(appliance.capture() == ResultCode::kPatternRepeated);
  cell.on_pulse = {};
  appliance.on_frame = {};
  CHECK(appliance.capture() == ResultCode::kOk);
}

TEST_CASE("interlocks abort the capture with their code, and nothing is left behind", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  SECTION("belt moves") {
    cell.on_pulse = [&](int pulse) {
      if (pulse == 4) cell.board->set_belt_stopped(false);
    };
    CHECK(appliance.capture() == ResultCode::kBeltMovedDuringCapture);
    CHECK(appliance.capture() == ResultCode::kBeltMovedDuringCapture);
    cell.board->set_belt_stopped(true);
  }
  SECTION("emergency stop") {
    cell.on_pulse = [&](int pulse) {
      if (pulse == 4) cell.board->set_emergency_stop(true);
    };
    CHECK(appliance.capture() == ResultCode::kEmergencyStop);
    CHECK(appliance.capture() == ResultCode::kEmergencyStop);
    cell.board->set_emergency_stop(false);
  }
  SECTION("the cycle cancels: robot in view") {
    appliance.on_frame = [&](int frame) {
      if (frame == 4) appliance.cancel = ResultCode::kRobotInView;
    };
    CHECK(appliance.capture() == ResultCode::kRobotInView);
    CHECK(appliance.taken < 17);
    CHECK(cell.board->status().state == protocol::State::kIdle);
    appliance.cancel = ResultCode::kOk;
  }
  SECTION("camera pulse cut") {
    cell.board->drop_camera_pulses(1);
    CHECK(appliance.capture() == ResultCode::kCameraNotTriggered);
  }
  SECTION("strobe cut: the camera's frame tells that it was exposed") {
    cell.board->drop_strobes(1);
    CHECK(static_cast<int>(appliance.capture()) == 201);
  }
  SECTION("the firmware hangs") {
    cell.on_pulse = [&](int pulse) {
      if (pulse == 4) cell.board->hang();
    };
    CHECK(static_cast<int>(appliance.capture()) == 212);
  }
  cell.on_pulse = {};
  appliance.on_frame = {};
  check_captures_well(appliance);
}

TEST_CASE("a trigger that falls silent is lost, and the capture after its return is good", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  cell.on_pulse = [&](int pulse) {
    if (pulse == 4) cell.board->mute(true);
  };
  CHECK(appliance.capture() == ResultCode::kTriggerLost);
  CHECK(appliance.capture() == ResultCode::kTriggerLost);
  cell.on_pulse = {};
  appliance.on_frame = {};
  cell.board->mute(false);
  REQUIRE(eventually([&] { return appliance.ready(); }));
  check_captures_well(appliance);
}

TEST_CASE("a dead camera is lost, is reopened by itself, and the next capture is good", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  REQUIRE(appliance.capture() == ResultCode::kOk);
  const bool at_any_moment = GENERATE(false, true);  // or just before a pulse
  std::thread killer;
  cell.on_pulse = [&](int pulse) {
    if (pulse != 4) return;
    if (at_any_moment) {
      killer = std::thread([&] { cell.camera->die(); });
    } else {
      cell.camera->die();
    }
  };
  CHECK(appliance.capture() == ResultCode::kCameraLost);
  if (killer.joinable()) killer.join();
  CHECK(appliance.camera.state() != capture::CameraState::kReady);
  const ResultCode still = appliance.capture();
  CHECK((still == ResultCode::kCameraLost || still == ResultCode::kCameraNotFound));
  cell.on_pulse = {};
  appliance.on_frame = {};
  cell.camera->revive();
  REQUIRE(eventually([&] { return appliance.ready(); }, 60000));
  check_captures_well(appliance);
}

TEST_CASE("a camera that dies between captures is noticed", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  cell.camera->die();
  CHECK(eventually([&] { return appliance.camera.state() == capture::CameraState::kLost; }));
  CHECK(appliance.camera.last_error().code == ResultCode::kCameraLost);
  cell.camera->revive();
  REQUIRE(eventually([&] { return appliance.ready(); }));
  CHECK(appliance.capture() == ResultCode::kOk);
}

TEST_CASE("a camera that is not there is told, and stopping does not wait for it", "[capture run]") {
  Arena measuring;
  const capture::CameraConfig config{.id = "127.0.0.99", .width = 16, .height = 16};
  const capture::Camera sized(config, measuring);
  ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  capture::Camera camera(config, arena);
  camera.start();
  REQUIRE(eventually([&] { return camera.last_error().text().find("does not answer") != std::string_view::npos; }));
  CHECK(camera.lease().error().code == ResultCode::kCameraNotFound);
}

TEST_CASE("a sensor smaller than the configured image is told", "[capture run]") {
  Cell cell;
  Arena measuring;
  const capture::CameraConfig config{.id = own_address(), .width = 2 * kCols, .height = kRows};
  const capture::Camera sized(config, measuring);
  ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  capture::Camera camera(config, arena);
  camera.start();
  REQUIRE(eventually([&] { return camera.last_error().code == ResultCode::kFrameWrongSize; }));
  CHECK(camera.state() == capture::CameraState::kOpening);
}
