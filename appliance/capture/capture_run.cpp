#include "capture/capture_run.hpp"

#include <algorithm>
#include <utility>

#include "base/clock.hpp"
#include "core/plan.hpp"

namespace beltpick::capture {

using protocol::Fault;
using protocol::State;
using protocol::Type;

namespace {

constexpr std::int64_t kLookEveryUs = 4'000;  // at signals, events and the clock while no frame comes
constexpr std::int64_t kStallUs = 1'200'000;  // without frame or event, beyond the longest period
constexpr std::int64_t kRecoverUs = 600'000;
constexpr std::int64_t kQuietUs = 60'000;             // without a frame: what was under way has arrived
constexpr std::int64_t kQuietUnanchoredUs = 400'000;  // when a straggler could not be told from the next frame

std::unexpected<Error> fault_of(Fault fault, unsigned frame) {
  const protocol::FaultEntry* entry = protocol::find_fault(fault);
  const char* name = entry != nullptr ? entry->name : "UNKNOWN";
  const char* cause = entry != nullptr ? entry->cause : "a fault of a newer firmware";
  const char* remedy = entry != nullptr ? entry->remedy : "update beltpick";
  if (frame == protocol::kNoFrame) {
    return failure(code_of(fault), "trigger: %s: %s; %s", name, cause, remedy);
  }
  return failure(code_of(fault), "trigger at frame %u: %s: %s; %s", frame, name, cause, remedy);
}

std::unexpected<Error> cancelled(ResultCode code) {
  const ResultCodeEntry* entry = find_result_code(code);
  const std::string_view cause = entry != nullptr ? entry->cause : "cancelled";
  const std::string_view remedy = entry != nullptr ? entry->remedy : "";
  return failure(code, "capture aborted: %.*s; %.*s", static_cast<int>(cause.size()), cause.data(),
                 static_cast<int>(remedy.size()), remedy.data());
}

bool is_strobe_fault(ResultCode code) {
  return code >= code_of(Fault::kStrobeMissing) && code <= code_of(Fault::kStrobeTooShort);
}

}  // namespace

struct CaptureRun::Progress {
  explicit Progress(const CapturePlan& capture_plan) : plan(capture_plan) {}

  const CapturePlan& plan;
  std::uint16_t arm_id = 0;
  bool done = false;
  int faulty_frame = -1;  // at which the trigger found fault
  std::int64_t started_us = monotonic_us();
  std::int64_t moved_us = monotonic_us();  // when the last frame or event came
  std::int64_t last_frame_us = 0;

  [[nodiscard]] int wanted() const { return static_cast<int>(plan.frames.size()); }
};

CaptureRun::CaptureRun(Camera& camera, TriggerSource& trigger, int max_frames, Arena& arena)
    : camera_(camera), trigger_(trigger), check_(max_frames, arena) {}

Result<CaptureReport> CaptureRun::run(const CapturePlan& plan, FrameSink& sink, const std::atomic<ResultCode>& cancel) {
  if (!trigger_.connected()) return std::unexpected(trigger_.last_error());
  Result<CameraLease> lease = camera_.lease();
  if (!lease) return std::unexpected(lease.error());
  Progress progress(plan);
  Result<CaptureReport> report = run_with(*lease, sink, cancel, progress);
  if (!report) return std::unexpected(recover(*lease, report.error(), progress));
  return report;
}

Result<CaptureReport> CaptureRun::run_with(CameraLease& lease, FrameSink& sink, const std::atomic<ResultCode>& cancel,
                                           Progress& progress) {
  Result<void> done = start(lease, progress.plan, progress);
  if (done) done = collect(lease, sink, cancel, progress);
  if (done) done = check_.judge(progress.plan.frames);
  if (!done) return std::unexpected(done.error());
  missing_in_a_row_ = 0;
  return CaptureReport{group_.frames(), group_.late(), progress.last_frame_us - progress.started_us,
                       progress.last_frame_us};
}

Result<void> CaptureRun::start(CameraLease& lease, const CapturePlan& plan, Progress& progress) {
  if (plan_number_ != plan.number) check_.forget();
  plan_number_ = plan.number;
  check_.begin();
  while (const std::optional<Frame> frame = lease.wait_frame(0)) {
    group_.came_idle(frame->frame_id);
    lease.requeue(*frame);
  }
  Result<void> done = trigger_.refresh_status();
  if (done && trigger_.status().state == State::kFault) done = clear_fault(trigger_.status().fault);
  if (done) done = group_.begin(progress.wanted(), trigger_.status().trigger_number, lease.generation());
  if (!done) return done;
  while (trigger_.next_event()) {
  }
  const Result<std::uint16_t> armed = trigger_.arm(plan.timing);
  if (!armed) return std::unexpected(armed.error());
  progress.arm_id = *armed;
  progress.moved_us = monotonic_us();
  return trigger_.start_sequence(*armed);
}

// What a capture before left latched was told then. That the firmware was reset meanwhile is told now, once.
Result<void> CaptureRun::clear_fault(Fault fault) {
  const Result<void> cleared = trigger_.clear();
  const bool told = std::exchange(start_fault_told_, false);
  if (!cleared || !protocol::from_start(fault)) return cleared;
  if (told) return trigger_.refresh_status();  // the one before still has it
  return fault_of(fault, protocol::kNoFrame);
}

Result<void> CaptureRun::collect(CameraLease& lease, FrameSink& sink, const std::atomic<ResultCode>& cancel,
                                 Progress& progress) {
  while (group_.frames() < progress.wanted() || !progress.done) {
    Result<void> well = look_around(lease, cancel, progress);
    if (!well) return well;
    const std::optional<Frame> frame = lease.wait_frame(kLookEveryUs);
    if (!frame) continue;
    well = take_frame(*frame, sink, progress);
    lease.requeue(*frame);
    if (!well) return well;
  }
  return {};
}

Result<void> CaptureRun::take_frame(const Frame& frame, FrameSink& sink, Progress& progress) {
  const Result<std::optional<int>> place = group_.place(frame.frame_id);
  if (!place) return std::unexpected(place.error());
  if (!*place) return {};
  if (frame.code == ResultCode::kFrameIncomplete) {
    return failure(
        frame.code,
        "frame %d of %d: packets were lost and not resent in time; check the network card and its receive buffers",
        **place, progress.wanted());
  }
  if (frame.code != ResultCode::kOk) {
    return failure(frame.code,
                   "frame %d of %d: expected %dx%d Mono8, found another size; check the camera's region of interest",
                   **place, progress.wanted(), camera_.width(), camera_.height());
  }
  progress.moved_us = progress.last_frame_us = monotonic_us();
  check_.add(frame.image);
  sink.take(**place, frame.image);
  return {};
}

unsigned CaptureRun::tick_ns() const {
  const std::optional<protocol::Identity> identity = trigger_.identity();
  return identity ? identity->tick_ns : core::kTick_ns;  // lines of the PC have the core's own
}

Result<void> CaptureRun::take_events(Progress& progress) {
  while (const std::optional<TriggerEvent> event = trigger_.next_event()) {
    progress.moved_us = monotonic_us();
    if (event->type == Type::kFrameEvent && event->frame.arm_id == progress.arm_id) {
      group_.exposed(event->frame, tick_ns());
    }
    if (event->type == Type::kDoneEvent && event->done.arm_id == progress.arm_id) progress.done = true;
    if (event->type == Type::kFaultEvent) return found_fault(event->fault.fault, event->fault.frame, progress);
  }
  if (const Result<void> going_on = trigger_.going_on(); !going_on) return going_on;
  // An event that the wire lost still stands in the status.
  const protocol::StatusReport status = trigger_.status();
  const bool of_this = status.arm_id == progress.arm_id || protocol::from_start(status.fault);
  if (!of_this) return {};
  if (status.state == State::kFault) return found_fault(status.fault, status.fault_frame, progress);
  if (status.state == State::kDone) progress.done = true;
  return {};
}

Result<void> CaptureRun::found_fault(Fault fault, unsigned frame, Progress& progress) {
  if (frame != protocol::kNoFrame) progress.faulty_frame = static_cast<int>(frame);
  start_fault_told_ = protocol::from_start(fault);
  return fault_of(fault, frame);
}

Result<void> CaptureRun::look_around(CameraLease& lease, const std::atomic<ResultCode>& cancel, Progress& progress) {
  const ResultCode wish = cancel;
  if (wish != ResultCode::kOk) return cancelled(wish);
  const Result<void> events = take_events(progress);
  if (!events) return events;
  if (!trigger_.connected()) return std::unexpected(trigger_.last_error());
  if (lease.lost())
    return failure(ResultCode::kCameraLost, "camera: lost after %d of %d frames", group_.frames(), progress.wanted());
  return judge_stall(progress);
}

// Time is up when nothing moves: the trigger's clock may be slower than ours, so its events count, not our estimate.
Result<void> CaptureRun::judge_stall(const Progress& progress) {
  std::int64_t period_us = 0;
  for (const protocol::Group& group : progress.plan.timing.groups)
    period_us = std::max<std::int64_t>(period_us, group.period_us);
  if (monotonic_us() - progress.moved_us < kStallUs + period_us) return {};
  if (progress.done) return std::unexpected(group_.missing());
  return failure(ResultCode::kCaptureTimeout,
                 "expected the sequence to end, found it stuck after %d of %d frames; check the trigger",
                 group_.frames(), progress.wanted());
}

// A camera that missed a pulse counts on from there without it: then the two counts have come apart.
bool CaptureRun::doubts_counts(const Error& error) {
  if (error.code == ResultCode::kFrameMissing) ++missing_in_a_row_;
  return is_strobe_fault(error.code) || error.code == ResultCode::kTriggerLost ||
         error.code == ResultCode::kTriggerLineNoisy || error.code == ResultCode::kFrameExtra || missing_in_a_row_ >= 2;
}

// Leaves trigger and camera as the next capture needs them. A camera that exposes wrongly or sends nothing may be a
// dead one: then that is the error to tell.
Error CaptureRun::recover(CameraLease& lease, const Error& error, const Progress& progress) {
  if (trigger_.connected()) static_cast<void>(trigger_.abort());
  const bool suspect = error.code == ResultCode::kFrameMissing || error.code == ResultCode::kFrameIncomplete ||
                       error.code == ResultCode::kCaptureTimeout || is_strobe_fault(error.code);
  const bool doubt = doubts_counts(error);
  const bool dead = lease.lost() || (suspect && !lease.answers());
  const bool exposed = !dead && swallow_late_frames(lease, doubt, progress);
  if (doubt) {
    group_.untie();
    missing_in_a_row_ = 0;
  }
  if (dead) return failure(ResultCode::kCameraLost, "camera: does not answer (%.200s)", error.detail).error();
  return exposed ? error : without_exposure(error, progress);
}

// Until no frame is under way any more. True when that at which the trigger found fault came: it was exposed.
bool CaptureRun::swallow_late_frames(CameraLease& lease, bool doubt, const Progress& progress) {
  bool came = group_.frames() > progress.faulty_frame;
  const std::int64_t until_us = monotonic_us() + kRecoverUs;
  while (monotonic_us() < until_us) {
    const std::optional<Frame> late = lease.wait_frame(group_.tied() && !doubt ? kQuietUs : kQuietUnanchoredUs);
    if (!late) break;
    came = came || group_.index_of(late->frame_id) >= progress.faulty_frame;
    lease.requeue(*late);
  }
  return came;
}

// What the strobe's fault comes to when the camera sent no frame either: the trigger's line is at fault, not the
// strobe's.
Error CaptureRun::without_exposure(const Error& error, const Progress& progress) {
  if (error.code == code_of(Fault::kStrobeMissing)) {
    return failure(ResultCode::kCameraNotTriggered,
                   "trigger at frame %d: no strobe, and the camera sent no frame: it was not triggered; check the "
                   "trigger line to the camera, and that the camera is armed on its line input",
                   progress.faulty_frame)
        .error();
  }
  if (error.code == code_of(Fault::kStrobeTooLong)) {
    return failure(ResultCode::kTriggerLineStuck,
                   "trigger at frame %d: the strobe goes on behind the pulse, and the camera sent no frame: it still "
                   "exposes; check the trigger line to the camera for a short to its supply",
                   progress.faulty_frame)
        .error();
  }
  return error;
}

}  // namespace beltpick::capture
