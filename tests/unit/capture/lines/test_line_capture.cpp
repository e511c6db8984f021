// Whole captures by lines of the PC, against the virtual camera: the seam to whoever triggers holds for them, too.
#include "../rig.hpp"
#include "capture/lines/line_trigger.hpp"
#include "fake_gpio.hpp"

using namespace rig;
using virtual_cell::gige::FrameFault;

namespace {

class LineAppliance : public capture::FrameSink {
 public:
  explicit LineAppliance(Cell& cell)
      : plan_(*capture::make_plan(
            patterns::standard(),
            {.exposure_us = 2000, .settle_us = 1000, .readout_us = 30'000, .strobe_tolerance_us = 20'000})),
        block_(measured_bytes()),
        arena_(block_.data(), block_.bytes()),
        camera_(camera_config(), arena_),
        run_(camera_, trigger_, kMaxFrames, arena_) {
    wire(cell, "camera", host::Pin::kCameraTrigger);
    wire(cell, "projector", host::Pin::kProjectorAdvance);
    wire(cell, "busy", host::Pin::kBusy);
    cell.on_strobe = [this](bool active) { gpio_.wires["strobe"].edge(active, monotonic_us()); };
    gpio_.wires["belt"].active = true;
    REQUIRE(lines_.open(gpio_));
    REQUIRE(trigger_.open(gpio_));
    camera_.start();
    lines_.start();
    trigger_.start();
    REQUIRE(eventually([&] { return camera_.state() == capture::CameraState::kReady && trigger_.connected(); }));
  }

  void take(int, ImageView<const std::uint8_t>) override { ++taken; }

  ResultCode capture() {
    taken = 0;
    const auto report = run_.run(plan_, *this, cancel_);
    text = report ? "" : report.error().detail;
    return report ? ResultCode::kOk : report.error().code;
  }

  int taken = 0;
  std::string text;

 private:
  void wire(Cell& cell, const char* name, host::Pin pin) {
    gpio_.wires[name].on_write = [&cell, pin](const capture::LineEdge& edge) {
      cell.on_edge({pin, edge.active, 0, edge.at_us * 1000});
    };
  }

  capture::CapturePlan plan_;
  ArenaBlock block_;
  Arena arena_;
  fake::FakeGpio gpio_;
  capture::CellLines lines_{
      {.belt_stopped = fake::line("belt"), .emergency_stop = fake::line("stop"), .debounce_ms = 0}};
  capture::Camera camera_;
  capture::LineTrigger trigger_{
      {fake::line("camera"), fake::line("projector"), fake::line("strobe"), fake::line("busy"), {}, 20'000}, lines_};
  std::atomic<ResultCode> cancel_{ResultCode::kOk};
  capture::CaptureRun run_;
};

}  // namespace

TEST_CASE("captures by lines of the PC: good ones, and a fault's code", "[line capture]") {
  Cell cell;
  LineAppliance appliance(cell);
  for (int i = 0; i < 3; ++i) {
    check_captures_well(appliance);
    CHECK(appliance.taken == 17);
  }
  CHECK(cell.camera->edges_while_exposing() == 0);
  for (const auto& [fault, expected] : {std::pair{FrameFault::kMissTrigger, ResultCode::kCameraNotTriggered},
                                        {FrameFault::kLoseFrame, ResultCode::kFrameMissing}}) {
    cell.camera->inject(fault, 5);
    CHECK(appliance.capture() == expected);
    CHECK_THAT(appliance.text, Catch::Contains("frame 5"));
    check_captures_well(appliance);
  }
}
