// Real-time priority of the few threads that a frame or the belt's permission waits for. They compute for well under a
// millisecond at a time and then wait; what computes for longer (decoding, pose search, service) stays ordinary, so
// that a machine with two cores keeps answering.
#pragma once

namespace beltpick {

// SCHED_FIFO priorities: all below those of the kernel's interrupt threads (50).
enum class RealtimePriority : int {
  kCapture = 5,   // folds frames
  kCycle = 10,    // decides
  kPlc = 10,      // tells
  kTrigger = 15,  // keeps the firmware's watch on a silent host content
  kStream = 20,   // empties the camera's socket
};

// Gives the calling thread that priority; threads it starts do not inherit it. False where the system does not allow
// it (RLIMIT_RTPRIO): the thread then stays ordinary.
bool make_realtime(RealtimePriority priority);
void make_ordinary();

// Real-time as long as it lives.
class RealtimeSection {
 public:
  explicit RealtimeSection(RealtimePriority priority) : is_realtime_(make_realtime(priority)) {}
  ~RealtimeSection() {
    if (is_realtime_) make_ordinary();
  }
  RealtimeSection(const RealtimeSection&) = delete;
  RealtimeSection& operator=(const RealtimeSection&) = delete;
  [[nodiscard]] bool is_realtime() const { return is_realtime_; }

 private:
  bool is_realtime_;
};

}  // namespace beltpick
