// A projector that leads: every frame is exposed with its own page, and what goes wrong on the way has its code.
#include "rig.hpp"

using namespace rig;

namespace {

// A display whose pages the camera of the cell sees.
struct Display : public capture::FrameShow {
  explicit Display(Cell& of) : cell(of) {}
  Result<std::int64_t> show(int frame) override {
    if (frame == fails_at) return failure(ResultCode::kProjectorSilent, "display: no flip");
    shown.push_back(frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));  // its frame clock
    const std::int64_t begun_us = monotonic_us();
    cell.page = frame;
    return begun_us;
  }
  Cell& cell;
  int fails_at = -1;
  std::vector<int> shown;
};

struct SteppedCell {
  Cell cell;
  Display display{cell};
  Appliance appliance{cell, &display};
};

}  // namespace

TEST_CASE("every page is shown once, in order, and exposed after its flip", "[stepped]") {
  SteppedCell stepped;
  auto& [cell, display, appliance] = stepped;
  for (int i = 0; i < 3; ++i) {
    display.shown.clear();
    const ResultCode code = appliance.capture();
    INFO(appliance.text);
    REQUIRE(code == ResultCode::kOk);  // the frame check finds a page that is exposed twice
    CHECK(appliance.taken == 17);
    REQUIRE(display.shown.size() == 17);
    for (int frame = 0; frame < 17; ++frame) CHECK(display.shown[static_cast<std::size_t>(frame)] == frame);
  }
  CHECK(cell.camera->edges_while_exposing() == 0);
  CHECK(rig::eventually([&] { return appliance.stepped->status().state == protocol::State::kDone; }));
}

TEST_CASE("a page that is not shown ends the capture with the projector's code, and the next one is good",
          "[stepped]") {
  SteppedCell stepped;
  auto& [cell, display, appliance] = stepped;
  for (const int frame : {0, 8, 16}) {
    display.fails_at = frame;
    CHECK(appliance.capture() == ResultCode::kProjectorSilent);
    CHECK(appliance.taken <= frame);
    display.fails_at = -1;
    check_captures_well(appliance);
  }
}

TEST_CASE("a fault in the midst names the frame of the whole sequence", "[stepped]") {
  SteppedCell stepped;
  auto& [cell, display, appliance] = stepped;
  cell.camera->inject(virtual_cell::gige::FrameFault::kMissTrigger, 5);
  CHECK(appliance.capture() == ResultCode::kCameraNotTriggered);
  INFO(appliance.text);
  CHECK(appliance.text.find("frame 5") != std::string::npos);
  check_captures_well(appliance);
}

TEST_CASE("a cancelled capture shows no further page", "[stepped]") {
  SteppedCell stepped;
  auto& [cell, display, appliance] = stepped;
  appliance.on_frame = [&](int frame) {
    if (frame == 3) appliance.cancel = ResultCode::kRobotInView;
  };
  CHECK(appliance.capture() == ResultCode::kRobotInView);
  CHECK(display.shown.size() <= 7);
  appliance.cancel = ResultCode::kOk;
  appliance.on_frame = nullptr;
  CHECK(appliance.capture() == ResultCode::kOk);
}

TEST_CASE("a sequence that the trigger refuses is refused as a whole, before a page is shown", "[stepped]") {
  SteppedCell stepped;
  auto& [cell, display, appliance] = stepped;
  protocol::Arm tight;
  tight.host_silence_ms = 500;
  tight.strobe_tolerance_us = 500;
  tight.group_count = 1;
  tight.groups[0].frames = 3;
  tight.groups[0].settle_us = 300;
  tight.groups[0].exposure_us = 9000;
  tight.groups[0].period_us = 5000;
  CHECK(appliance.stepped->arm(tight).error().code == ResultCode::kValueOutOfRange);
  CHECK(display.shown.empty());
}
