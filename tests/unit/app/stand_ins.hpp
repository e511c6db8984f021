// Stand-ins for camera, trigger, pipeline and models: what a test wants them to say.
#pragma once

#include <utility>
#include <vector>

#include "app/digital_lines.hpp"
#include "app/models.hpp"
#include "app/vision.hpp"

namespace beltpick::app {

class StandInVision : public Vision {
 public:
  int started = 0, aborted = 0, processed = 0;
  bool is_idle = true;
  ResultCode device = ResultCode::kOk;
  std::uint16_t capture = 0;
  cycle::CaptureOutcome next_capture;
  cycle::LocateOutcome next_locate;
  std::vector<LocatedPart> parts;

  void start_capture(std::uint16_t number) override {
    ++started;
    capture = number;
  }
  void abort_capture(ResultCode) override { ++aborted; }
  void start_processing(std::uint16_t) override { ++processed; }
  cycle::CaptureOutcome take_capture_outcome() override { return std::exchange(next_capture, {}); }
  cycle::LocateOutcome take_locate_outcome() override { return std::exchange(next_locate, {}); }
  [[nodiscard]] bool idle() const override { return is_idle; }
  [[nodiscard]] ResultCode device_code() const override { return device; }

  void capture_ends(ResultCode code = ResultCode::kOk) { next_capture = {true, capture, code}; }
  void locate_ends(ResultCode code = ResultCode::kOk) {
    next_locate = {true, capture, code, parts, 0, ResultCode::kOk};
  }
};

class StandInLines : public DigitalLines {
 public:
  LineLevels levels{true, true, false};
  bool may_move = false;
  LineLevels read() override { return levels; }
  void permit_belt(bool permitted) override { may_move = permitted; }
};

class StandInModels : public Models {
 public:
  std::uint16_t recipe = 1;
  ResultCode model_code = ResultCode::kOk;
  bool changed = false;
  OfferFrame frame;
  Grasp only_grasp;

  [[nodiscard]] std::uint16_t active_recipe() const override { return recipe; }
  [[nodiscard]] bool knows_recipe(std::uint16_t number) const override { return number == 1 || number == 2; }
  [[nodiscard]] ResultCode code() const override { return model_code; }
  [[nodiscard]] std::int64_t capture_time_us() const override { return 500'000; }
  [[nodiscard]] bool idle() const override { return true; }
  bool take_changed() override { return std::exchange(changed, false); }
  void select_recipe(std::uint16_t number) override { recipe = number; }
  [[nodiscard]] OfferFrame offer_frame() const override { return frame; }
  [[nodiscard]] const Grasp* grasp(int, int) const override { return &only_grasp; }
};

}  // namespace beltpick::app
