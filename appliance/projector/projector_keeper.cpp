#include "projector/projector_keeper.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::projector {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLookEvery{1000};
constexpr milliseconds kRetryEvery{1000};
constexpr milliseconds kStep{5};

}  // namespace

ProjectorKeeper::ProjectorKeeper(std::unique_ptr<Projector> projector)
    : projector_(std::move(projector)), facts_(projector_->facts()) {}

ProjectorKeeper::~ProjectorKeeper() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (!thread_.joinable()) return;
  thread_.join();
  if (code_ == ResultCode::kOk) static_cast<void>(projector_->stop());  // one that is gone is dark
}

void ProjectorKeeper::start() {
  thread_ = std::thread([this] { run(); });
  pthread_setname_np(thread_.native_handle(), "projector");
}

void ProjectorKeeper::use(const ShowPlan& plan) {
  {
    const std::lock_guard lock(mutex_);
    plan_ = plan;
    state_ = State::kNew;
    tried_ = false;
  }
  changed_.notify_all();
}

Result<void> ProjectorKeeper::begin(int timeout_ms, const std::atomic<ResultCode>& cancel) {
  const std::int64_t until_us = monotonic_us() + timeout_ms * 1000LL;
  std::unique_lock lock(mutex_);
  for (;;) {
    const ResultCode wish = cancel;
    if (wish != ResultCode::kOk) return failure(wish, "capture aborted while the projector got ready");
    const std::int64_t now_us = monotonic_us();
    if (!busy_ && state_ == State::kReady && now_us >= ready_us_) break;
    if (!busy_ && error_.code != ResultCode::kOk) return std::unexpected(error_);
    if (now_us > until_us) {
      return failure(ResultCode::kProjectorSilent, "projector: expected it to be ready within %d ms, found it busy",
                     timeout_ms);
    }
    changed_.wait_for(lock, kStep);
  }
  state_ = State::kCapturing;
  return {};
}

Result<void> ProjectorKeeper::end(bool doubt) {
  const Result<void> well = doubt ? projector_->check() : Result<void>();
  {
    const std::lock_guard lock(mutex_);
    if (state_ == State::kCapturing) state_ = well ? State::kUsed : State::kNew;
    if (!well) take(well);
  }
  changed_.notify_all();
  return well;
}

Error ProjectorKeeper::last_error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

ProjectorFacts ProjectorKeeper::facts() const {
  const std::lock_guard lock(mutex_);
  return facts_;
}

bool ProjectorKeeper::has_plan() const {
  const std::lock_guard lock(mutex_);
  return plan_.has_value();
}

void ProjectorKeeper::run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (state_ == State::kNew || state_ == State::kUsed) {
      make_ready(lock);
      if (state_ == State::kReady || stopping_) continue;
      changed_.wait_for(lock, kRetryEvery, [&] { return stopping_; });
    } else if (state_ == State::kReady) {
      changed_.wait_for(lock, kLookEvery, [&] { return stopping_ || state_ != State::kReady; });
      if (state_ == State::kReady && !stopping_) look_after(lock);
    } else {
      changed_.wait(lock, [&] { return stopping_ || state_ == State::kNew || state_ == State::kUsed; });
    }
  }
}

// Talks to the projector without holding the lock; a plan that came meanwhile is taken in the next round.
void ProjectorKeeper::make_ready(std::unique_lock<std::mutex>& lock) {
  const bool anew = state_ == State::kNew;
  state_ = State::kUsed;
  busy_ = true;
  std::optional<ShowPlan> plan;
  if (anew) plan = plan_;
  lock.unlock();
  Result<void> done;
  if (anew) done = projector_->prepare(*plan);
  if (done) done = projector_->start();
  if (done) done = projector_->check();
  if (!done) projector_->close();
  const ProjectorFacts facts = anew ? projector_->facts() : ProjectorFacts();
  lock.lock();
  busy_ = false;
  if (anew) facts_ = facts;
  if (state_ == State::kUsed) {
    state_ = done ? State::kReady : State::kNew;
    ready_us_ = monotonic_us() + projector_->ready_in_us();
    take(done);
  }
  changed_.notify_all();
}

void ProjectorKeeper::look_after(std::unique_lock<std::mutex>& lock) {
  busy_ = true;
  lock.unlock();
  const Result<void> well = projector_->check();
  if (!well) projector_->close();
  lock.lock();
  busy_ = false;
  take(well);
  if (!well && state_ == State::kReady) state_ = State::kNew;
  changed_.notify_all();
}

// Under the lock.
void ProjectorKeeper::take(const Result<void>& outcome) {
  error_ = outcome ? Error() : outcome.error();
  code_ = error_.code;
  tried_ = true;
}

}  // namespace beltpick::projector
