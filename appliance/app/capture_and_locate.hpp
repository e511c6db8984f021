// CaptureAndLocate: the vision thread's work with the real camera, trigger and pipeline.
#pragma once

#include "app/belt_watch.hpp"
#include "app/log.hpp"
#include "app/model_hub.hpp"
#include "app/recorder.hpp"
#include "app/refused_grasps.hpp"
#include "app/run_book.hpp"
#include "app/settings.hpp"
#include "app/vision_work.hpp"
#include "capture/camera.hpp"
#include "capture/capture_run.hpp"
#include "capture/trigger_source.hpp"
#include "decode/findings.hpp"
#include "pipeline/locate.hpp"
#include "pipeline/measure.hpp"
#include "projector/projector_keeper.hpp"
#include "segment/segmenter.hpp"

namespace beltpick::app {

class CaptureAndLocate : public VisionWork {
 public:
  struct Neighbours {
    capture::Camera& camera;
    capture::TriggerSource& trigger;
    const ModelHub& hub;
    Recorder& recorder;
    projector::ProjectorKeeper& projector;
    RunBook& book;
    const RefusedGrasps& refused;
    Log& log;
  };

  CaptureAndLocate(Arena& arena, const Settings& settings, const Neighbours& neighbours);

  // Makes the pipeline ready for a recipe, whose fold plan it takes; while neither capture nor locate runs. Takes a
  // tenth of a second where the calibration is another one.
  Result<void> adopt(const Geometry& geometry, LoadedRecipe& recipe);

  Result<void> capture(std::uint16_t number, const std::atomic<ResultCode>& cancel) override;
  Result<Located> locate(std::uint16_t number) override;
  [[nodiscard]] bool idle() const override { return to_.recorder.idle(); }
  [[nodiscard]] ResultCode device_code() const override;

 private:
  class FoldFrames;

  Result<void> run_capture(FoldFrames& sink, const std::atomic<ResultCode>& cancel);
  void tell_findings(const std::optional<Error>& of_belt);
  std::span<const WithheldObject> withheld(const pipeline::LocateOutput& found, int left_out);

  const Settings& settings_;
  Neighbours to_;
  capture::CaptureRun run_;
  pipeline::Measure measure_;
  segment::Segmenter segmenter_;
  pipeline::Locator locator_;
  BeltWatch belt_watch_;
  std::span<WithheldObject> withheld_;
  std::int64_t last_frame_us_ = 0;
  decode::Findings told_;  // of the capture before: what goes on is not said again
};

}  // namespace beltpick::app
