#include "pipeline/worker_team.hpp"

#include <pthread.h>

namespace beltpick::pipeline {

WorkerTeam::WorkerTeam(int workers) {
  for (int i = 1; i < workers; ++i) {
    threads_.emplace_back([this, i] { work_until_stopped(i); });
    pthread_setname_np(threads_.back().native_handle(), "pose");
  }
}

WorkerTeam::~WorkerTeam() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerTeam::take_tasks(int worker) {
  for (int task = next_.fetch_add(1); task < tasks_; task = next_.fetch_add(1)) call_(job_, worker, task);
}

void WorkerTeam::work_until_stopped(int worker) {
  std::uint64_t seen = 0;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      start_.wait(lock, [&] { return stop_ || round_ != seen; });
      if (stop_) return;
      seen = round_;
    }
    take_tasks(worker);
    const std::lock_guard lock(mutex_);
    if (--busy_ == 0) done_.notify_one();
  }
}

void WorkerTeam::run_erased(int tasks, Call call, void* job) {
  {
    const std::lock_guard lock(mutex_);
    call_ = call;
    job_ = job;
    tasks_ = tasks;
    next_ = 0;
    busy_ = static_cast<int>(threads_.size());
    ++round_;
  }
  start_.notify_all();
  take_tasks(0);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [&] { return busy_ == 0; });
}

}  // namespace beltpick::pipeline
