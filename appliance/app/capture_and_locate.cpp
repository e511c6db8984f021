#include "app/capture_and_locate.hpp"

#include <algorithm>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::app {

namespace {

constexpr int kProjectorReady_ms = 5000;

// What a projector that stands or is gone looks like to the camera, or told itself.
bool may_be_projector(ResultCode code) {
  return code == ResultCode::kFrameBlack || code == ResultCode::kFrameDuplicated ||
         (code >= ResultCode::kProjectorLost && code <= ResultCode::kProjectorFault);
}

}  // namespace

// Folds each frame as it arrives and shows it to the recorder. The first failure voids the capture.
class CaptureAndLocate::FoldFrames : public capture::FrameSink {
 public:
  FoldFrames(pipeline::Measure& measure, Recorder& recorder) : measure_(measure), recorder_(recorder) {}

  void take(int frame, ImageView<const std::uint8_t> image) override {
    recorder_.keep_frame(frame, image);
    if (!outcome_) return;
    outcome_ = measure_.fold(frame, image);
  }
  [[nodiscard]] const Result<void>& outcome() const { return outcome_; }

 private:
  pipeline::Measure& measure_;
  Recorder& recorder_;
  Result<void> outcome_;
};

CaptureAndLocate::CaptureAndLocate(Arena& arena, const Settings& settings, const Neighbours& neighbours)
    : settings_(settings),
      to_(neighbours),
      run_(neighbours.camera, neighbours.trigger, settings.limits.frames, arena),
      measure_(arena, settings.limits),
      segmenter_(arena, settings.limits),
      locator_(arena, settings.limits, settings.pose_workers),
      belt_watch_(settings.belt_wander_mm),
      withheld_(arena.take<WithheldObject>(
          "withheld objects", static_cast<std::size_t>(settings.limits.segments + settings.limits.parts) + 1)) {}

Result<void> CaptureAndLocate::adopt(const Geometry& geometry, LoadedRecipe& recipe) {
  to_.projector.use(recipe.show);
  belt_watch_.use(geometry.calibration, geometry.cell);
  return measure_.adopt(std::move(recipe.fold), geometry.calibration);
}

ResultCode CaptureAndLocate::device_code() const {
  if (!to_.trigger.connected()) return to_.trigger.last_error().code;
  if (to_.camera.state() == capture::CameraState::kReady) return to_.projector.code();
  const ResultCode code = to_.camera.last_error().code;
  return code == ResultCode::kOk ? ResultCode::kCameraNotFound : code;
}

Result<void> CaptureAndLocate::capture(std::uint16_t number, const std::atomic<ResultCode>& cancel) {
  to_.recorder.begin();
  const Stopwatch watch;
  FoldFrames sink(measure_, to_.recorder);
  const Result<void> outcome = run_capture(sink, cancel);
  to_.book.add_capture(!outcome);
  if (outcome) {
    to_.book.add_time(Step::kCapture, watch.elapsed_ms());
  } else {
    to_.recorder.keep_failure(number, outcome.error().code);
  }
  return outcome;
}

Result<void> CaptureAndLocate::run_capture(FoldFrames& sink, const std::atomic<ResultCode>& cancel) {
  if (const auto begun = measure_.begin(); !begun) return begun;
  if (const auto ready = to_.projector.begin(kProjectorReady_ms, cancel); !ready) return ready;
  const auto report = run_.run(to_.hub.recipe().plan, sink, cancel);
  const auto well = to_.projector.end(!report && may_be_projector(report.error().code));
  if (!well) return well;
  if (!report) return std::unexpected(report.error());
  last_frame_us_ = report->last_frame_us;
  if (report->late_frames > 0) {
    to_.log.write(LogLevel::kWarning, "capture: %d frames of an earlier one came late, and were swallowed",
                  report->late_frames);
  }
  return sink.outcome();
}

Result<Located> CaptureAndLocate::locate(std::uint16_t number) {
  const auto range = measure_.finish();
  if (!range) {
    to_.recorder.keep_failure(number, range.error().code);
    return std::unexpected(range.error());
  }
  to_.book.set_pixels(count_pixels(measure_.code().state));
  const Stopwatch segment_watch;
  const segment::Segmented objects = segmenter_.segment(*range);
  const double segment_ms = segment_watch.elapsed_ms();
  tell_findings(belt_watch_.see(objects.belt));
  to_.book.set_belt_nearer(belt_watch_.nearer_mm());

  const Stopwatch locate_watch;
  const Calibration& calibration = to_.hub.geometry().calibration;
  std::array<RefusedGrasps::GripperPose, RefusedGrasps::kMost> refused;
  const pipeline::LocateInput input{.range = *range,
                                    .labels = objects.labels,
                                    .segments = objects.segments,
                                    .belt = objects.belt,
                                    .lens = calibration.camera,
                                    .seed = number,
                                    .projector_mm = pipeline::projector_position_mm(calibration),
                                    .refused_grasps = to_.refused.copy(refused)};
  const pipeline::LocateOutput found = locator_.locate(input, to_.hub.models());
  const double locate_ms = locate_watch.elapsed_ms();

  const auto not_identified = withheld(found, objects.left_out);
  const pipeline::MeasureTiming& timing = measure_.timing();
  to_.book.add_time(Step::kFold, timing.fold_ms);
  to_.book.add_time(Step::kDecode, timing.decode_ms);
  to_.book.add_time(Step::kRange, timing.range_ms);
  to_.book.add_time(Step::kSegment, segment_ms);
  to_.book.add_time(Step::kLocate, locate_ms);
  for (const double object_ms : found.object_ms) to_.book.add_time(Step::kLocatePart, object_ms);
  to_.book.add_time(Step::kLastFrameToPoses, static_cast<double>(monotonic_us() - last_frame_us_) / 1000.0);
  to_.book.set_view(static_cast<int>(found.parts.size()), not_identified);
  to_.recorder.keep_result({number, *range, objects.labels, found.parts, not_identified, timing.decode_ms,
                            timing.range_ms, segment_ms, locate_ms});
  return Located{found.parts, not_identified};
}

// Warns of what is not right with the captures, when it begins.
void CaptureAndLocate::tell_findings(const std::optional<Error>& of_belt) {
  const auto before = told_;
  told_.clear();
  for (const Error& finding : measure_.findings()) told_.add(finding);
  if (of_belt) told_.add(*of_belt);
  const auto known = before.all();
  for (const Error& finding : told_.all()) {
    const bool new_one =
        std::none_of(known.begin(), known.end(), [&](const Error& e) { return e.code == finding.code; });
    if (new_one) to_.log.write(LogLevel::kWarning, "capture: %s", finding.detail);
  }
}

// What the locator withheld, and what was never looked at because there were more objects than declared.
std::span<const WithheldObject> CaptureAndLocate::withheld(const pipeline::LocateOutput& found, int left_out) {
  const std::size_t count = std::min(found.withheld.size(), withheld_.size() - 1);
  std::copy_n(found.withheld.begin(), count, withheld_.begin());
  if (left_out == 0) return withheld_.first(count);
  withheld_[count] = {
      0, Stage::kSegment,
      failure(ResultCode::kSegmentLimit, "%d objects beyond limits.segments (%d) were left out; raise it", left_out,
              settings_.limits.segments)
          .error()};
  return withheld_.first(count + 1);
}

}  // namespace beltpick::app
