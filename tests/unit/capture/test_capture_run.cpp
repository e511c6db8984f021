// Whole captures against the virtual camera and the host board: what passes, and every fault with its code and its way
// back.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <functional>
#include <memory>
#include <vector>

#include "base/clock.hpp"
#include "capture/capture_run.hpp"
#include "host/board.hpp"
#include "patterns.hpp"
#include "virtual_cell/gige/camera.hpp"

using namespace beltpick;
using virtual_cell::gige::FrameFault;

namespace {

constexpr int kRows = 240;
constexpr int kCols = 320;

bool eventually(const std::function<bool()>& condition, int patience_ms = 20000) {
  const std::int64_t until_us = monotonic_us() + patience_ms * std::int64_t{1000};
  while (monotonic_us() < until_us) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

// Several test programs may run at once: each listens at an address of its own.
std::string own_address() {
  const auto pid = static_cast<unsigned>(::getpid());
  return "127." + std::to_string(1 + (pid >> 8U) % 250) + "." + std::to_string(pid % 256) + ".77";
}

// Camera, projector and trigger, wired as a cell is.
class Cell {
 public:
  Cell() {
    virtual_cell::gige::CameraSettings settings;
    settings.identity.width = kCols;
    settings.identity.height = kRows;
    settings.address = own_address();
    settings.fill = [this](ImageView<std::uint8_t> image, const virtual_cell::gige::Exposure& exposure) {
      patterns::render(image,
                       sequence_.frames[shown_[exposure.trigger_number % shown_.size()] % sequence_.frames.size()], {},
                       random_);
    };
    settings.exposure_began = [this](const virtual_cell::gige::Exposure& exposure) {
      shown_[exposure.trigger_number % shown_.size()] = pattern_;
      board->set_strobe(true);
    };
    auto opened = virtual_cell::gige::Camera::open(settings);
    REQUIRE(opened);
    camera = std::move(*opened);
    board = std::make_unique<host::Board>(host::BoardOptions{
        .link = {}, .belt_stopped = true, .emergency_stop = false, .on_edge = [this](const host::PinEdge& e) {
          on_edge(e);
        }});
  }

  std::unique_ptr<virtual_cell::gige::Camera> camera;
  std::unique_ptr<host::Board> board;

 private:
  void on_edge(const host::PinEdge& edge) {
    if (edge.pin == host::Pin::kBusy && edge.level) pattern_ = 0xFFFFFFFF;
    if (edge.pin == host::Pin::kProjectorAdvance && edge.level) ++pattern_;
    if (edge.pin != host::Pin::kCameraTrigger) return;
    camera->line_edge(edge.level, edge.at_ns / 1000);
    if (!edge.level) board->set_strobe(false);
  }

  Sequence sequence_ = patterns::standard();
  std::vector<unsigned> shown_ = std::vector<unsigned>(256);
  unsigned pattern_ = 0;
  Random random_{3};
};

// The appliance's side.
class Appliance : public capture::FrameSink {
 public:
  explicit Appliance(const Cell& cell)
      : plan_(*capture::make_plan(
            patterns::standard(),
            {.exposure_us = 1000, .settle_us = 300, .readout_us = 3000, .strobe_tolerance_us = 800})),
        block_(measured()),
        arena_(block_.data(), block_.bytes()),
        camera(config(), arena_),
        trigger({.tty = cell.board->tty()}),
        run_(camera, trigger, kMaxFrames, arena_) {
    camera.start();
    trigger.start();
    REQUIRE(eventually([&] { return ready(); }));
  }

  bool ready() const { return camera.state() == capture::CameraState::kReady && trigger.connected(); }

  void take(int frame, ImageView<const std::uint8_t> image) override {
    in_order_ = in_order_ && frame == taken && image.rows == kRows && image.cols == kCols;
    ++taken;
    if (on_frame) on_frame(frame);
  }

  ResultCode capture() {
    taken = 0;
    in_order_ = true;
    const auto report = run_.run(plan_, *this, cancel);
    text = report ? "" : report.error().detail;
    CHECK(in_order_);
    return report ? ResultCode::kOk : report.error().code;
  }

 private:
  static constexpr int kMaxFrames = 32;
  static capture::CameraConfig config() {
    return {.id = own_address(), .width = kCols, .height = kRows, .watch_ms = 200};
  }
  static std::size_t measured() {
    Arena arena;
    const capture::Camera camera(config(), arena);
    const capture::FrameCheck check(kMaxFrames, arena);
    return arena.used_bytes();
  }

  capture::CapturePlan plan_;
  ArenaBlock block_;
  Arena arena_;

 public:
  capture::Camera camera;
  capture::TriggerLink trigger;
  std::atomic<ResultCode> cancel{ResultCode::kOk};
  std::function<void(int)> on_frame;
  int taken = 0;
  std::string text;

 private:
  bool in_order_ = true;
  capture::CaptureRun run_;
};

}  // namespace

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
                                                              {FrameFault::kMissTrigger, 201}}));
  for (const int frame : {0, 5, 15}) {
    if (fault == FrameFault::kDuplicate && frame == 0) continue;
    cell.camera->inject(fault, frame);
    const ResultCode found = appliance.capture();
    INFO("frame " << frame << ": " << appliance.text);
    CHECK(static_cast<int>(found) == code);
    const bool named = appliance.text.find("frame " + std::to_string(frame)) != std::string::npos;
    CHECK(named);
    const ResultCode next = appliance.capture();
    INFO(appliance.text);
    CHECK(next == ResultCode::kOk);
  }
}

TEST_CASE("a last frame that never arrives is missing", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  cell.camera->inject(FrameFault::kLoseFrame, 16);
  CHECK(appliance.capture() == ResultCode::kFrameMissing);
  CHECK(appliance.capture() == ResultCode::kOk);
}

TEST_CASE("a missed projector advance is a duplicated frame", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  appliance.on_frame = [&](int frame) {
    if (frame == 3) cell.board->drop_projector_advances(1);
  };
  CHECK(appliance.capture() == ResultCode::kFrameDuplicated);
  appliance.on_frame = {};
  CHECK(appliance.capture() == ResultCode::kOk);
}

TEST_CASE("interlocks abort the capture with their code, and nothing is left behind", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  SECTION("belt moves") {
    appliance.on_frame = [&](int frame) {
      if (frame == 4) cell.board->set_belt_stopped(false);
    };
    CHECK(appliance.capture() == ResultCode::kBeltMovedDuringCapture);
    CHECK(appliance.capture() == ResultCode::kBeltMovedDuringCapture);
    cell.board->set_belt_stopped(true);
  }
  SECTION("emergency stop") {
    appliance.on_frame = [&](int frame) {
      if (frame == 4) cell.board->set_emergency_stop(true);
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
    CHECK(static_cast<int>(appliance.capture()) == 201);
  }
  appliance.on_frame = {};
  const ResultCode next = appliance.capture();
  INFO(appliance.text);
  CHECK(next == ResultCode::kOk);
}

TEST_CASE("a trigger that falls silent is lost, and the capture after its return is good", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  appliance.on_frame = [&](int frame) {
    if (frame == 4) cell.board->mute(true);
  };
  CHECK(appliance.capture() == ResultCode::kTriggerLost);
  CHECK(appliance.capture() == ResultCode::kTriggerLost);
  appliance.on_frame = {};
  cell.board->mute(false);
  REQUIRE(eventually([&] { return appliance.ready(); }));
  const ResultCode next = appliance.capture();
  INFO(appliance.text);
  CHECK(next == ResultCode::kOk);
}

TEST_CASE("a dead camera is lost, is reopened by itself, and the next capture is good", "[capture run]") {
  Cell cell;
  Appliance appliance(cell);
  REQUIRE(appliance.capture() == ResultCode::kOk);
  appliance.on_frame = [&](int frame) {
    if (frame == 4) cell.camera->die();
  };
  CHECK(appliance.capture() == ResultCode::kCameraLost);
  CHECK(appliance.camera.state() != capture::CameraState::kReady);
  const ResultCode still = appliance.capture();
  CHECK((still == ResultCode::kCameraLost || still == ResultCode::kCameraNotFound));
  appliance.on_frame = {};
  cell.camera->revive();
  REQUIRE(eventually([&] { return appliance.ready(); }, 60000));
  const ResultCode next = appliance.capture();
  INFO(appliance.text);
  CHECK(next == ResultCode::kOk);
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
