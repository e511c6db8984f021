// FakeGpio: the GPIO functions without a chip: a test sets the inputs with their times, and sees the outputs.
#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "base/clock.hpp"
#include "capture/lines/gpio.hpp"
#include "contract/result_codes.hpp"

namespace fake {

using namespace beltpick;
using namespace beltpick::capture;

// What stands behind one line; outlives the request of it.
struct Wire {
  std::mutex mutex;
  bool active = false;
  bool gone = false;  // the chip was taken away
  std::atomic<int> holders{0};
  std::atomic<int> writes{0};
  std::deque<LineEdge> edges;
  std::function<void(const LineEdge&)> on_write;  // in the thread that drives the line
  int fd = ::eventfd(0, EFD_NONBLOCK | EFD_SEMAPHORE | EFD_CLOEXEC);

  ~Wire() { ::close(fd); }
  void edge(bool level, std::int64_t at_us) {
    const std::lock_guard lock(mutex);
    active = level;
    edges.push_back({level, at_us});
    const std::uint64_t one = 1;
    (void)!::write(fd, &one, sizeof one);
  }
  void take_away() {
    const std::lock_guard lock(mutex);
    gone = true;
    const std::uint64_t one = 1;
    (void)!::write(fd, &one, sizeof one);
  }
  bool level() {
    const std::lock_guard lock(mutex);
    return active;
  }
};

class HeldLine : public GpioLine {
 public:
  explicit HeldLine(Wire& wire) : wire_(wire) { ++wire_.holders; }
  ~HeldLine() override { --wire_.holders; }

  Result<bool> read() override {
    const std::lock_guard lock(wire_.mutex);
    if (wire_.gone) return failure(ResultCode::kLinesLost, "gone");
    return wire_.active;
  }
  Result<void> write(bool active) override {
    {
      const std::lock_guard lock(wire_.mutex);
      if (wire_.gone) return failure(ResultCode::kLinesLost, "gone");
      wire_.active = active;
      ++wire_.writes;
    }
    if (wire_.on_write) wire_.on_write({active, monotonic_us()});
    return {};
  }
  Result<std::optional<LineEdge>> next_edge() override {
    const std::lock_guard lock(wire_.mutex);
    if (wire_.gone) return failure(ResultCode::kLinesLost, "gone");
    if (wire_.edges.empty()) return std::nullopt;
    std::uint64_t one = 0;
    (void)!::read(wire_.fd, &one, sizeof one);
    const LineEdge edge = wire_.edges.front();
    wire_.edges.pop_front();
    return edge;
  }
  [[nodiscard]] int edge_fd() const override { return wire_.fd; }

 private:
  Wire& wire_;
};

class FakeGpio : public Gpio {
 public:
  Result<std::unique_ptr<GpioLine>> request(const LineSpec& spec, LineUse, const char* name) override {
    if (spec.line == "missing") return failure(ResultCode::kLineNotFound, "lines.%s: missing", name);
    return std::make_unique<HeldLine>(wires[spec.line]);
  }

  std::map<std::string, Wire> wires;
};

// With a camera that answers at once: the strobe is the pulse itself, stamped when it was driven.
class EchoGpio : public FakeGpio {
 public:
  EchoGpio() {
    wires["camera"].on_write = [this](const LineEdge& edge) {
      if (!deaf || !edge.active) wires["strobe"].edge(edge.active, edge.at_us);
      if (on_pulse) on_pulse(edge);
    };
  }
  std::atomic<bool> deaf{false};
  std::function<void(const LineEdge&)> on_pulse;
};

inline LineSpec line(const char* name) { return {"chip", name, false, LineBias::kAsIs}; }

}  // namespace fake
