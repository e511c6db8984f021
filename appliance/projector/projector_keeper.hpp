// ProjectorKeeper: keeps the projector ready for the next capture, in a thread of its own: opens it, gives it the
// sequence in use, puts it back to the first pattern after every capture, looks after it once a second, and finds it
// again after a loss. A capture only asks whether it is ready.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "base/result.hpp"
#include "projector/projector.hpp"

namespace beltpick::projector {

class ProjectorKeeper {
 public:
  explicit ProjectorKeeper(std::unique_ptr<Projector> projector);
  ~ProjectorKeeper();  // leaves the projector dark
  ProjectorKeeper(const ProjectorKeeper&) = delete;
  ProjectorKeeper& operator=(const ProjectorKeeper&) = delete;

  // Starts the thread; returns at once.
  void start();

  // The sequence from now on. Not during a capture.
  void use(const ShowPlan& plan);

  // Called by the thread that captures; allocates nothing. Waits until the next advance shows the first pattern; from
  // here to end() the projector is left alone. Errors: why it is not ready; kProjectorSilent after `timeout_ms`; what
  // `cancel` says other than kOk.
  Result<void> begin(int timeout_ms, const std::atomic<ResultCode>& cancel);
  // The capture is over, however it ended. With `doubt` the projector is asked whether it is its fault: its error.
  Result<void> end(bool doubt);

  // A frame of the sequence, between begin() and end(), where the projector leads; see Projector::show().
  Result<std::int64_t> show(int frame) { return projector_->show(frame); }
  [[nodiscard]] bool leads() const { return projector_->leads(); }

  // Why a capture could not be made at this moment; kOk also while no sequence is in use yet. Any thread.
  [[nodiscard]] ResultCode code() const { return code_; }
  // The same with its text.
  [[nodiscard]] Error last_error() const;
  [[nodiscard]] ProjectorFacts facts() const;
  // True once use() was called.
  [[nodiscard]] bool has_plan() const;
  // True once it is known whether it is good with the sequence in use.
  [[nodiscard]] bool tried() const { return tried_; }

 private:
  enum class State : std::uint8_t { kNoPlan, kNew, kUsed, kReady, kCapturing };

  void run();
  void make_ready(std::unique_lock<std::mutex>& lock);
  void look_after(std::unique_lock<std::mutex>& lock);
  void take(const Result<void>& outcome);

  std::unique_ptr<Projector> projector_;  // the thread's, from begin() to end() the caller's
  std::atomic<ResultCode> code_{ResultCode{}};
  std::atomic<bool> tried_{false};

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  State state_ = State::kNoPlan;
  std::optional<ShowPlan> plan_;
  bool busy_ = false;  // the thread talks to the projector
  std::int64_t ready_us_ = 0;
  ProjectorFacts facts_;
  Error error_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace beltpick::projector
