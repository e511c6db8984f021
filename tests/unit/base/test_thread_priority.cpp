// Real-time priority holds for the section and is not inherited; where it is not allowed nothing changes.
#include <sched.h>

#include <catch2/catch.hpp>
#include <thread>

#include "base/thread_priority.hpp"

using namespace beltpick;

namespace {
int policy_of_this_thread() { return ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; }
}  // namespace

TEST_CASE("a section is real-time where that is allowed, and ordinary afterwards") {
  {
    const RealtimeSection section(RealtimePriority::kCapture);
    CHECK(policy_of_this_thread() == (section.is_realtime() ? SCHED_FIFO : SCHED_OTHER));
    int inherited = -1;
    std::thread([&] { inherited = policy_of_this_thread(); }).join();
    CHECK(inherited == SCHED_OTHER);
  }
  CHECK(policy_of_this_thread() == SCHED_OTHER);
}
