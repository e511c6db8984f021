// VisionThread: the thread that captures and locates when the cycle says so. Allocates nothing after start.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "app/log.hpp"
#include "app/vision.hpp"
#include "app/vision_work.hpp"
#include "app/watchdog.hpp"

namespace beltpick::app {

class VisionThread : public Vision {
 public:
  VisionThread(VisionWork& work, Log& log, Watchdog::Beat& beat);
  ~VisionThread() override;  // stops it
  VisionThread(const VisionThread&) = delete;
  VisionThread& operator=(const VisionThread&) = delete;

  // Cancels what runs. A capture ends within milliseconds, locating at its own pace.
  void ask_to_stop();
  // False when the thread has not ended within the time.
  bool wait_stopped(int timeout_ms);

  void start_capture(std::uint16_t capture) override;
  void abort_capture(ResultCode why) override;
  void start_processing(std::uint16_t capture) override;
  cycle::CaptureOutcome take_capture_outcome() override;
  cycle::LocateOutcome take_locate_outcome() override;
  [[nodiscard]] bool idle() const override;
  [[nodiscard]] ResultCode device_code() const override { return work_.device_code(); }

 private:
  enum class Job : std::uint8_t { kNone, kCapture, kLocate };

  void run();
  void do_capture(std::uint16_t capture);
  void do_locate(std::uint16_t capture);
  void give(Job job, std::uint16_t capture);
  void tell_failure(const char* what, std::uint16_t capture, const Error& error);

  VisionWork& work_;
  Log& log_;
  Watchdog::Beat& beat_;
  std::atomic<ResultCode> cancel_{ResultCode::kOk};

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wanted_, ended_;
  Job job_ = Job::kNone;
  std::uint16_t job_capture_ = 0;
  bool working_ = false;
  bool stop_ = false;
  bool has_ended_ = false;
  cycle::CaptureOutcome capture_outcome_;
  cycle::LocateOutcome locate_outcome_;
  std::thread thread_;
};

}  // namespace beltpick::app
