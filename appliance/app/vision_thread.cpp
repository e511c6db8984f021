#include "app/vision_thread.hpp"

#include <pthread.h>

#include <chrono>
#include <utility>

#include "base/clock.hpp"
#include "base/thread_priority.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::app {

VisionThread::VisionThread(VisionWork& work, Log& log, Watchdog::Beat& beat)
    : work_(work), log_(log), beat_(beat), thread_([this] { run(); }) {
  pthread_setname_np(thread_.native_handle(), "vision");
}

VisionThread::~VisionThread() {
  ask_to_stop();
  thread_.join();
}

void VisionThread::ask_to_stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    cancel_ = ResultCode::kRestarted;
  }
  wanted_.notify_all();
}

bool VisionThread::wait_stopped(int timeout_ms) {
  std::unique_lock lock(mutex_);
  return ended_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [this] { return has_ended_; });
}

void VisionThread::start_capture(std::uint16_t capture) { give(Job::kCapture, capture); }
void VisionThread::start_processing(std::uint16_t capture) { give(Job::kLocate, capture); }

void VisionThread::give(Job job, std::uint16_t capture) {
  {
    const std::lock_guard lock(mutex_);
    if (stop_) return;
    job_ = job;
    job_capture_ = capture;
    if (job == Job::kCapture) cancel_ = ResultCode::kOk;  // the thread is idle: nothing else looks at it
  }
  wanted_.notify_all();
}

void VisionThread::abort_capture(ResultCode why) {
  const std::lock_guard lock(mutex_);
  // An end that the PLC asked for is no failure, yet the capture must know that it is over.
  if (!stop_) cancel_ = why == ResultCode::kOk ? ResultCode::kRestarted : why;
}

cycle::CaptureOutcome VisionThread::take_capture_outcome() {
  const std::lock_guard lock(mutex_);
  return std::exchange(capture_outcome_, {});
}

cycle::LocateOutcome VisionThread::take_locate_outcome() {
  const std::lock_guard lock(mutex_);
  return std::exchange(locate_outcome_, {});
}

bool VisionThread::idle() const {
  const std::lock_guard lock(mutex_);
  return job_ == Job::kNone && !working_ && work_.idle();
}

void VisionThread::run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    beat_(monotonic_us());
    if (job_ == Job::kNone) {
      wanted_.wait_for(lock, std::chrono::milliseconds(100));
      continue;
    }
    const Job job = std::exchange(job_, Job::kNone);
    const std::uint16_t capture = job_capture_;
    working_ = true;
    lock.unlock();
    if (job == Job::kCapture) {
      do_capture(capture);
    } else {
      do_locate(capture);
    }
    lock.lock();
    working_ = false;
  }
  has_ended_ = true;
  ended_.notify_all();
}

void VisionThread::do_capture(std::uint16_t capture) {
  const auto done = [&] {
    const RealtimeSection section(RealtimePriority::kCapture);
    return work_.capture(capture, cancel_);
  }();
  if (!done) tell_failure("capture", capture, done.error());
  const std::lock_guard lock(mutex_);
  capture_outcome_ = {true, capture, done ? ResultCode::kOk : done.error().code};
}

void VisionThread::do_locate(std::uint16_t capture) {
  const auto located = work_.locate(capture);
  if (!located) tell_failure("locating of capture", capture, located.error());
  cycle::LocateOutcome outcome;
  outcome.ended = true;
  outcome.capture = capture;
  if (located) {
    outcome.parts = located->parts;
    outcome.withheld = static_cast<int>(located->withheld.size());
    if (!located->withheld.empty()) outcome.withheld_code = located->withheld.front().reason.code;
  } else {
    outcome.code = located.error().code;
  }
  const std::lock_guard lock(mutex_);
  locate_outcome_ = outcome;
}

void VisionThread::tell_failure(const char* what, std::uint16_t capture, const Error& error) {
  if (cancel_ != ResultCode::kOk) return;  // who cancelled it tells why
  log_.write(LogLevel::kWarning, "%s %u failed: %s: %s", what, capture, result_code_name(error.code).data(),
             error.detail);
}

}  // namespace beltpick::app
