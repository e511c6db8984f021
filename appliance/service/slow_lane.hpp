// SlowLane: a thread that gives the slow answers one after the other, so that the quick ones need not wait for them.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace beltpick::service {

class SlowLane {
 public:
  static constexpr std::size_t kWaiting = 4;

  // `beat` is called between jobs, at least every 200 ms.
  explicit SlowLane(std::function<void()> beat);
  ~SlowLane();
  SlowLane(const SlowLane&) = delete;
  SlowLane& operator=(const SlowLane&) = delete;

  // False where too many wait already.
  bool add(std::function<void()> job);
  // Takes no more; jobs that have not begun are dropped. False where the one that runs did not end in time.
  bool stop(int patience_ms);

 private:
  void run();

  std::function<void()> beat_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  bool stop_ = false;
  bool ended_ = false;
  std::thread thread_;
};

// Ordinary scheduling, nineteen steps of niceness below the rest of the process: nothing the service does may delay a
// cycle. For the calling thread.
void lower_priority(const char* thread_name);

}  // namespace beltpick::service
