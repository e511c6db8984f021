#include "service/slow_lane.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace beltpick::service {
namespace {

constexpr int kBelow = 19;  // the rest of the process
constexpr int kLowest = 19;
constexpr std::chrono::milliseconds kBeat{200};

}  // namespace

void lower_priority(const char* thread_name) {
  pthread_setname_np(pthread_self(), thread_name);
  const sched_param none{};  // a real-time priority is inherited from whoever started the thread
  pthread_setschedparam(pthread_self(), SCHED_BATCH, &none);
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  setpriority(PRIO_PROCESS, thread, std::min(kLowest, getpriority(PRIO_PROCESS, thread) + kBelow));
}

SlowLane::SlowLane(std::function<void()> beat) : beat_(std::move(beat)), thread_([this] { run(); }) {}

SlowLane::~SlowLane() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool SlowLane::add(std::function<void()> job) {
  const std::lock_guard lock(mutex_);
  if (stop_ || jobs_.size() == kWaiting) return false;
  jobs_.push_back(std::move(job));
  changed_.notify_all();
  return true;
}

bool SlowLane::stop(int patience_ms) {
  std::unique_lock lock(mutex_);
  stop_ = true;
  changed_.notify_all();
  return changed_.wait_for(lock, std::chrono::milliseconds(patience_ms), [this] { return ended_; });
}

void SlowLane::run() {
  lower_priority("https-slow");
  std::unique_lock lock(mutex_);
  while (!stop_) {
    beat_();
    if (jobs_.empty()) {
      changed_.wait_for(lock, kBeat);
      continue;
    }
    const auto job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job();
    lock.lock();
  }
  ended_ = true;
  changed_.notify_all();
}

}  // namespace beltpick::service
