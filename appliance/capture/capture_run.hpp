// CaptureRun: one capture from ARM to the last frame: starts the sequence, hands each frame to the fold as it arrives,
// and ends with its own result code whatever goes wrong. Allocates nothing per capture.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "base/arena.hpp"
#include "base/image.hpp"
#include "base/result.hpp"
#include "capture/camera.hpp"
#include "capture/capture_plan.hpp"
#include "capture/frame_check.hpp"
#include "capture/frame_group.hpp"
#include "capture/trigger_source.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

// Takes the frames of a capture, in the order of the sequence, within the thread that calls run(). After a failed
// capture what was taken is void.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  virtual void take(int frame, ImageView<const std::uint8_t> image) = 0;
};

struct CaptureReport {
  int frames = 0;
  int late_frames = 0;             // images of earlier captures that came during this one, and were swallowed
  std::int64_t duration_us = 0;    // ARM to the last frame folded
  std::int64_t last_frame_us = 0;  // monotonic_us() of the last frame's arrival: where "last frame -> pose" begins
};

class CaptureRun {
 public:
  // `max_frames`: the declared limit (Limits::frames); the check's samples come from the arena.
  CaptureRun(Camera& camera, TriggerSource& trigger, int max_frames, Arena& arena);

  // Runs one capture; blocks for its duration. `cancel` is looked at every few milliseconds: any code but kOk aborts
  // the capture with that code (robot in view, belt moved by the register, emergency stop, timeout, clean stop). A
  // firmware fault that is latched from before is cleared first: the cell's own fault latch is what a person
  // acknowledges. One that nobody was told of yet, of a reset of the firmware, fails this capture. After a failure the
  // outputs of the trigger are safe and late frames are swallowed, so that the next run starts clean.
  //
  // Errors: kCameraLost, kCameraNotFound, kCameraNotTriggered, kTriggerLost, kTriggerLineNoisy, kTriggerLineStuck,
  // kFrameMissing, kFrameExtra, kFrameIncomplete, kFrameWrongSize, kFrameBlack, kFrameDuplicated,
  // kPatternRepeated, kBeltMovedDuringCapture, kEmergencyStop, kCaptureTimeout, 200 + n, and whatever `cancel` said.
  Result<CaptureReport> run(const CapturePlan& plan, FrameSink& sink, const std::atomic<ResultCode>& cancel);

 private:
  struct Progress;

  Result<CaptureReport> run_with(CameraLease& lease, FrameSink& sink, const std::atomic<ResultCode>& cancel,
                                 Progress& progress);
  Result<void> start(CameraLease& lease, const CapturePlan& plan, Progress& progress);
  Result<void> clear_fault(protocol::Fault fault);
  Result<void> collect(CameraLease& lease, FrameSink& sink, const std::atomic<ResultCode>& cancel, Progress& progress);
  Result<void> take_frame(const Frame& frame, FrameSink& sink, Progress& progress);
  [[nodiscard]] unsigned tick_ns() const;
  Result<void> take_events(Progress& progress);
  Result<void> found_fault(protocol::Fault fault, unsigned frame, Progress& progress);
  Result<void> look_around(CameraLease& lease, const std::atomic<ResultCode>& cancel, Progress& progress);
  Result<void> judge_stall(const Progress& progress);
  Error recover(CameraLease& lease, const Error& error, const Progress& progress);
  bool doubts_counts(const Error& error);
  bool swallow_late_frames(CameraLease& lease, bool doubt, const Progress& progress);
  static Error without_exposure(const Error& error, const Progress& progress);

  Camera& camera_;
  TriggerSource& trigger_;
  FrameCheck check_;
  FrameGroup group_;
  int missing_in_a_row_ = 0;       // captures with missing frames; two of them discredit the tie of the counts
  unsigned plan_number_ = 0;       // that the frame check learnt from
  bool start_fault_told_ = false;  // a fault of the firmware's own start failed the capture before
};

}  // namespace beltpick::capture
