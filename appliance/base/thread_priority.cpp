#include "base/thread_priority.hpp"

#include <sched.h>

namespace beltpick {

namespace {

// On Linux 0 means the calling thread, not the process.
bool set_policy(int policy, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return ::sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &parameters) == 0;
}

}  // namespace

bool make_realtime(RealtimePriority priority) { return set_policy(SCHED_FIFO, static_cast<int>(priority)); }

void make_ordinary() { set_policy(SCHED_OTHER, 0); }

}  // namespace beltpick
