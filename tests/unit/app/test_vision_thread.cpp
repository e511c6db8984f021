#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "app/vision_thread.hpp"
#include "base/clock.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

// Captures until it is told to end; locates as long as it is told to.
class SlowWork : public VisionWork {
 public:
  std::atomic<bool> finish{false};
  std::atomic<bool> frozen{false};
  std::vector<LocatedPart> parts{LocatedPart{}};
  std::vector<WithheldObject> objects{
      WithheldObject{3, Stage::kVerify, failure(ResultCode::kCoverageTooLow, "test").error()}};

  Result<void> capture(std::uint16_t, const std::atomic<ResultCode>& cancel) override {
    while (!finish) {
      if (cancel != ResultCode::kOk) return failure(cancel, "cancelled");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return {};
  }
  Result<Located> locate(std::uint16_t) override {
    while (frozen) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (parts.empty()) return failure(ResultCode::kFrameBlack, "test");
    return Located{parts, objects};
  }
  [[nodiscard]] ResultCode device_code() const override { return ResultCode::kOk; }
};

template <class Ready>
bool soon(Ready ready) {
  for (int i = 0; i < 3000; ++i) {
    if (ready()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

struct Bench {
  SlowWork work;
  Log log;
  Watchdog watchdog;
  VisionThread vision{work, log, watchdog.add("vision", 1000, monotonic_us())};
};

}  // namespace

TEST_CASE("a capture and its locating report once, with their number", "[vision]") {
  Bench bench;
  CHECK(bench.vision.idle());
  bench.vision.start_capture(7);
  CHECK_FALSE(bench.vision.idle());
  CHECK_FALSE(bench.vision.take_capture_outcome().ended);
  bench.work.finish = true;
  cycle::CaptureOutcome capture;
  REQUIRE(soon([&] { return (capture = bench.vision.take_capture_outcome()).ended; }));
  CHECK((capture.capture == 7 && capture.code == ResultCode::kOk));
  CHECK_FALSE(bench.vision.take_capture_outcome().ended);

  bench.vision.start_processing(7);
  cycle::LocateOutcome located;
  REQUIRE(soon([&] { return (located = bench.vision.take_locate_outcome()).ended; }));
  CHECK(located.parts.size() == 1);
  CHECK(located.withheld == 1);
  CHECK(located.withheld_code == ResultCode::kCoverageTooLow);

  bench.work.parts.clear();
  bench.vision.start_processing(7);
  REQUIRE(soon([&] { return (located = bench.vision.take_locate_outcome()).ended; }));
  CHECK(located.code == ResultCode::kFrameBlack);
}

TEST_CASE("an aborted capture ends soon with the reason, and the next one starts clean", "[vision]") {
  Bench bench;
  bench.vision.start_capture(1);
  bench.vision.abort_capture(ResultCode::kRobotInView);
  cycle::CaptureOutcome capture;
  REQUIRE(soon([&] { return (capture = bench.vision.take_capture_outcome()).ended; }));
  CHECK(capture.code == ResultCode::kRobotInView);
  REQUIRE(soon([&] { return bench.vision.idle(); }));
  bench.work.finish = true;
  bench.vision.start_capture(2);
  REQUIRE(soon([&] { return (capture = bench.vision.take_capture_outcome()).ended; }));
  CHECK((capture.capture == 2 && capture.code == ResultCode::kOk));
}

TEST_CASE("a stop in the midst of a capture ends it; one in the midst of locating is told to be late", "[vision]") {
  Bench bench;
  bench.vision.start_capture(1);
  SECTION("capture") {
    bench.vision.ask_to_stop();
    CHECK(bench.vision.wait_stopped(3000));
  }
  SECTION("locating") {
    bench.work.finish = true;
    REQUIRE(soon([&] { return bench.vision.take_capture_outcome().ended; }));
    bench.work.frozen = true;
    bench.vision.start_processing(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    bench.vision.ask_to_stop();
    CHECK_FALSE(bench.vision.wait_stopped(50));
    bench.work.frozen = false;
    CHECK(bench.vision.wait_stopped(3000));
  }
}
