#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <thread>

#include "contract/result_codes.hpp"
#include "projector/edge_projector.hpp"
#include "projector/projector_keeper.hpp"

using namespace beltpick;
using namespace beltpick::projector;

namespace {

const std::atomic<ResultCode> kGoOn{ResultCode::kOk};

// A projector whose every answer is set from outside.
struct Fake {
  std::atomic<ResultCode> prepare{ResultCode::kOk}, start{ResultCode::kOk}, check{ResultCode::kOk};
  std::atomic<int> prepared{0}, started{0}, stopped{0}, closed{0};
};

class FakeProjector : public Projector {
 public:
  explicit FakeProjector(Fake& fake) : fake_(fake) {}
  Result<void> prepare(const ShowPlan&) override { return count(fake_.prepared, fake_.prepare); }
  Result<void> start() override { return count(fake_.started, fake_.start); }
  Result<void> stop() override { return count(fake_.stopped, ResultCode::kOk); }
  Result<void> check() override { return answer(fake_.check); }
  void close() override { ++fake_.closed; }
  [[nodiscard]] ProjectorFacts facts() const override { return {"fake", "here", "1", ""}; }
  [[nodiscard]] std::uint32_t ready_in_us() const override { return 30'000; }
  Result<std::int64_t> show(int) override { return 0; }

 private:
  static Result<void> answer(ResultCode code) {
    if (code == ResultCode::kOk) return {};
    return failure(code, "fake");
  }
  static Result<void> count(std::atomic<int>& calls, ResultCode code) {
    ++calls;
    return answer(code);
  }
  Fake& fake_;
};

bool wait_until(const std::function<bool()>& condition) {
  for (int i = 0; i < 500 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

}  // namespace

TEST_CASE("A capture begins at the first pattern, and the next one too", "[keeper]") {
  Fake fake;
  {
    ProjectorKeeper keeper(std::make_unique<FakeProjector>(fake));
    keeper.start();
    CHECK_FALSE(keeper.has_plan());
    CHECK(keeper.code() == ResultCode::kOk);
    CHECK(keeper.begin(20, kGoOn).error().code == ResultCode::kProjectorSilent);
    keeper.use({});
    for (int capture = 1; capture <= 3; ++capture) {
      const auto from = std::chrono::steady_clock::now();
      REQUIRE(keeper.begin(5000, kGoOn));
      if (capture > 1) CHECK(std::chrono::steady_clock::now() - from >= std::chrono::milliseconds(20));  // it loads
      CHECK(fake.started == capture);
      REQUIRE(keeper.end(false));
    }
    CHECK(fake.prepared == 1);
    REQUIRE(keeper.begin(5000, kGoOn));
    REQUIRE(keeper.end(false));
    keeper.use({});
    REQUIRE(keeper.begin(5000, kGoOn));
    CHECK(fake.prepared == 2);
    REQUIRE(keeper.end(false));
    CHECK(keeper.facts().name == "fake");
  }
  CHECK(fake.stopped == 1);
}

TEST_CASE("A projector that fails is told, closed and prepared anew until it is well", "[keeper]") {
  Fake fake;
  fake.prepare = ResultCode::kProjectorLost;
  ProjectorKeeper keeper(std::make_unique<FakeProjector>(fake));
  keeper.use({});
  keeper.start();
  REQUIRE(wait_until([&] { return keeper.tried(); }));
  CHECK(keeper.code() == ResultCode::kProjectorLost);
  CHECK(keeper.begin(5000, kGoOn).error().code == ResultCode::kProjectorLost);
  fake.prepare = ResultCode::kOk;
  REQUIRE(wait_until([&] { return keeper.code() == ResultCode::kOk; }));
  fake.check = ResultCode::kProjectorFault;
  REQUIRE(wait_until([&] { return keeper.code() == ResultCode::kProjectorFault; }));
  CHECK(fake.closed >= 2);
  fake.check = ResultCode::kOk;
  REQUIRE(wait_until([&] { return keeper.code() == ResultCode::kOk; }));
}

TEST_CASE("A capture that looks as if the projector stood asks it", "[keeper]") {
  Fake fake;
  ProjectorKeeper keeper(std::make_unique<FakeProjector>(fake));
  keeper.use({});
  keeper.start();
  REQUIRE(keeper.begin(5000, kGoOn));
  CHECK(keeper.end(true));
  REQUIRE(keeper.begin(5000, kGoOn));
  fake.check = ResultCode::kProjectorFault;
  CHECK(keeper.end(true).error().code == ResultCode::kProjectorFault);
  fake.check = ResultCode::kOk;
  REQUIRE(wait_until([&] { return keeper.code() == ResultCode::kOk; }));
  CHECK(fake.prepared >= 2);
}

TEST_CASE("A capture that is cancelled does not wait for the projector", "[keeper]") {
  Fake fake;
  ProjectorKeeper keeper(std::make_unique<FakeProjector>(fake));
  keeper.start();  // without a sequence it is never ready
  std::atomic<ResultCode> cancel{ResultCode::kOk};
  std::thread person([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    cancel = ResultCode::kRobotInView;
  });
  CHECK(keeper.begin(60'000, cancel).error().code == ResultCode::kRobotInView);
  person.join();
}

TEST_CASE("A projector that only advances on an edge is always ready", "[keeper]") {
  ProjectorKeeper keeper(std::make_unique<EdgeProjector>());
  keeper.start();
  keeper.use({});
  for (int i = 0; i < 20; ++i) {
    REQUIRE(keeper.begin(5000, kGoOn));
    REQUIRE(keeper.end(i % 2 == 0));
  }
  CHECK_FALSE(keeper.leads());
  CHECK(keeper.show(0).error().code == ResultCode::kInternal);
}
