// A cell of virtual camera, projector and board, and the appliance's capture side of it.
#pragma once

#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/clock.hpp"
#include "capture/capture_run.hpp"
#include "capture/stepped_trigger.hpp"
#include "capture/trigger_link.hpp"
#include "host/board.hpp"
#include "patterns.hpp"
#include "virtual_cell/gige/camera.hpp"

namespace rig {

using namespace beltpick;
inline constexpr int kRows = 240;
inline constexpr int kCols = 320;

inline bool eventually(const std::function<bool()>& condition, int patience_ms = 20000) {
  const std::int64_t until_us = monotonic_us() + patience_ms * std::int64_t{1000};
  while (monotonic_us() < until_us) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

// Several test programs may run at once: each listens at an address of its own.
inline std::string own_address() {
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
      if (slow_frame-- == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2500));
      patterns::render(image,
                       sequence_.frames[shown_[exposure.trigger_number % shown_.size()] % sequence_.frames.size()], {},
                       random_);
    };
    settings.exposure_began = [this](const virtual_cell::gige::Exposure& exposure) {
      const int led_page = page;
      shown_[exposure.trigger_number % shown_.size()] = led_page >= 0 ? static_cast<unsigned>(led_page) : pattern_;
      set_strobe(true);
    };
    settings.exposure_ended = [this](const virtual_cell::gige::Exposure&) { set_strobe(false); };
    auto opened = virtual_cell::gige::Camera::open(settings);
    REQUIRE(opened);
    camera = std::move(*opened);
    board = std::make_unique<host::Board>(host::BoardOptions{
        .link = {}, .belt_stopped = true, .emergency_stop = false, .on_edge = [this](const host::PinEdge& e) {
          on_edge(e);
        }});
  }

  // What an output of whoever triggers does: of the board, or of lines.
  void on_edge(const host::PinEdge& edge) {
    if (edge.pin == host::Pin::kBusy && edge.level) pattern_ = 0xFFFFFFFF;
    if (edge.pin == host::Pin::kProjectorAdvance && edge.level) ++pattern_;
    if (edge.pin == host::Pin::kBusy) pulses_ = 0;
    if (edge.pin != host::Pin::kCameraTrigger) return;
    if (edge.level && on_pulse) on_pulse(pulses_++);
    camera->line_edge(edge.level, edge.at_ns / 1000);
  }

  std::function<void(bool)> on_strobe;  // takes the strobe in the board's place
  std::function<void(int)> on_pulse;    // of the sequence that runs, from 0; set while none does
  std::atomic<int> page{-1};            // shown by a display, not by advance pulses, where it is not negative
  std::atomic<int> slow_frame{-1};      // frames until one whose readout takes longer than anybody waits
  std::unique_ptr<virtual_cell::gige::Camera> camera;
  std::unique_ptr<host::Board> board;

 private:
  void set_strobe(bool active) {
    if (on_strobe) return on_strobe(active);
    board->set_strobe(active);
  }

  Sequence sequence_ = patterns::standard();
  std::vector<unsigned> shown_ = std::vector<unsigned>(256);
  unsigned pattern_ = 0;
  int pulses_ = 0;
  Random random_{3};
};

inline constexpr int kMaxFrames = 32;

inline capture::CameraConfig camera_config() {
  return {.id = own_address(), .width = kCols, .height = kRows, .watch_ms = 200};
}

// What the capture side takes of an arena.
inline std::size_t measured_bytes() {
  Arena arena;
  const capture::Camera camera(camera_config(), arena);
  const capture::FrameCheck check(kMaxFrames, arena);
  return arena.used_bytes();
}

// Of an appliance with capture() and the text of its last error.
template <class Appliance>
void check_captures_well(Appliance& appliance) {
  const ResultCode code = appliance.capture();
  INFO(appliance.text);
  CHECK(code == ResultCode::kOk);
}

// The appliance's side.
class Appliance : public capture::FrameSink {
 public:
  // `show`: of a projector that leads.
  explicit Appliance(const Cell& cell, capture::FrameShow* show = nullptr)
      : plan_(*capture::make_plan(
            patterns::standard(),
            {.exposure_us = 1000, .settle_us = 300, .readout_us = 6000, .strobe_tolerance_us = 800})),
        block_(measured_bytes()),
        arena_(block_.data(), block_.bytes()),
        camera(camera_config(), arena_),
        trigger({.tty = cell.board->tty()}),
        stepped(show != nullptr ? std::make_unique<capture::SteppedTrigger>(trigger, *show, 2000) : nullptr),
        run_(camera, stepped ? static_cast<capture::TriggerSource&>(*stepped) : trigger, kMaxFrames, arena_) {
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

  Result<capture::CaptureReport> run() {
    taken = 0;
    in_order_ = true;
    return run_.run(plan_, *this, cancel);
  }

  ResultCode capture() {
    const auto report = run();
    text = report ? "" : report.error().detail;
    CHECK(in_order_);
    return report ? ResultCode::kOk : report.error().code;
  }

 private:
  capture::CapturePlan plan_;
  ArenaBlock block_;
  Arena arena_;

 public:
  capture::Camera camera;
  capture::TriggerLink trigger;
  std::unique_ptr<capture::SteppedTrigger> stepped;
  std::atomic<ResultCode> cancel{ResultCode::kOk};
  std::function<void(int)> on_frame;
  int taken = 0;
  std::string text;

 private:
  bool in_order_ = true;
  capture::CaptureRun run_;
};

}  // namespace rig
