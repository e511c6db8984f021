// WorkerTeam: a fixed number of threads, started once, that share out numbered tasks. Allocates nothing when it runs.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace beltpick::pipeline {

class WorkerTeam {
 public:
  // The caller of run() is one of the workers: `workers` - 1 threads are started.
  explicit WorkerTeam(int workers);
  ~WorkerTeam();
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  [[nodiscard]] int workers() const { return static_cast<int>(threads_.size()) + 1; }

  // Calls job(worker, task) for every task in [0, tasks), each once, and returns when all are done. Which worker takes
  // which task is left to chance: a job's result must depend on its task alone.
  template <class Job>
  void run(int tasks, Job& job) {
    run_erased(
        tasks, [](void* of, int worker, int task) { (*static_cast<Job*>(of))(worker, task); }, &job);
  }

 private:
  using Call = void (*)(void* job, int worker, int task);
  void run_erased(int tasks, Call call, void* job);
  void work_until_stopped(int worker);
  void take_tasks(int worker);

  std::mutex mutex_;
  std::condition_variable start_, done_;
  std::uint64_t round_ = 0;
  int busy_ = 0;
  bool stop_ = false;
  Call call_ = nullptr;
  void* job_ = nullptr;
  int tasks_ = 0;
  std::atomic<int> next_{0};
  std::vector<std::thread> threads_;
};

}  // namespace beltpick::pipeline
