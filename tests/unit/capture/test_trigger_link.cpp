#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>

#include "base/clock.hpp"
#include "capture/trigger_link.hpp"
#include "contract/result_codes.hpp"
#include "host/board.hpp"

using namespace beltpick;

namespace {

// Generous: only a failing test waits that long.
bool eventually(const std::function<bool()>& condition, int patience_ms = 10000) {
  const std::int64_t until_us = monotonic_us() + patience_ms * std::int64_t{1000};
  while (monotonic_us() < until_us) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return condition();
}

// A board whose camera mirrors pulse and strobe, behind a link that survives the board's end.
struct Bench {
  Bench() : tty(std::filesystem::temp_directory_path() / ("beltpick-link-" + std::to_string(::getpid()))) {
    power_up();
  }

  void power_up() {
    host::BoardOptions options;
    options.link = tty;
    options.belt_stopped = true;
    options.on_edge = [this](const host::PinEdge& edge) {
      if (edge.pin == host::Pin::kCameraTrigger) board->set_strobe(edge.level);
    };
    board.emplace(options);
  }

  static protocol::Arm sequence(std::uint16_t frames, std::uint32_t exposure_us = 500) {
    protocol::Arm arm;
    arm.host_silence_ms = 2000;
    arm.strobe_tolerance_us = 300;
    arm.group_count = 1;
    arm.groups[0] = {frames, 200, exposure_us, 2000, 1000};
    return arm;
  }

  std::string tty;
  std::optional<host::Board> board;
};

}  // namespace

TEST_CASE("a sequence through the link: all frames in order, then done", "[trigger link]") {
  Bench bench;
  capture::TriggerLink link({.tty = bench.tty});
  CHECK_FALSE(link.inputs().known);
  CHECK_FALSE(link.inputs().belt_stopped);
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  CHECK(link.inputs().belt_stopped);
  for (int run = 0; run < 3; ++run) {
    const auto armed = link.arm(Bench::sequence(30));
    REQUIRE(armed);
    REQUIRE(link.start_sequence(*armed));
    std::uint16_t frames = 0;
    bool done = false;
    REQUIRE(eventually([&] {
      while (const auto event = link.next_event()) {
        if (event->type == protocol::Type::kFrameEvent) CHECK(event->frame.frame == frames++);
        if (event->type == protocol::Type::kDoneEvent) done = event->done.arm_id == *armed;
      }
      return done;
    }));
    CHECK(frames == 30);
  }
  CHECK(link.events_lost() == 0);
}

TEST_CASE("what cannot be run is refused with its reason", "[trigger link]") {
  Bench bench;
  capture::TriggerLink link({.tty = bench.tty});
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  const auto too_long = link.arm(Bench::sequence(3, 1500));
  REQUIRE_FALSE(too_long);
  CHECK(too_long.error().code == ResultCode::kValueOutOfRange);
  CHECK(too_long.error().text().find("period is shorter") != std::string_view::npos);
  bench.board->set_belt_stopped(false);
  const auto armed = link.arm(Bench::sequence(3));
  REQUIRE(armed);
  const auto started = link.start_sequence(*armed);
  REQUIRE_FALSE(started);
  CHECK(started.error().code == ResultCode::kBeltMovedDuringCapture);
}

TEST_CASE("inputs follow the pins, and faults latch until cleared", "[trigger link]") {
  Bench bench;
  capture::TriggerLink link({.tty = bench.tty});
  link.start();
  REQUIRE(eventually([&] { return link.inputs().belt_stopped; }));
  const std::int64_t before_us = link.inputs().changed_us;
  bench.board->set_belt_stopped(false);
  REQUIRE(eventually([&] { return !link.inputs().belt_stopped; }));
  CHECK(link.inputs().changed_us > before_us);
  bench.board->set_belt_stopped(true);
  bench.board->set_emergency_stop(true);
  REQUIRE(eventually([&] { return link.inputs().emergency_stop; }));
  CHECK(link.clear().error().code == ResultCode::kEmergencyStop);
  CHECK(link.arm(Bench::sequence(3)).error().code == ResultCode::kEmergencyStop);
  bench.board->set_emergency_stop(false);
  REQUIRE(eventually([&] { return link.clear().has_value(); }));
  CHECK(link.arm(Bench::sequence(3)));
}

TEST_CASE("a mute line is a lost trigger with unsafe inputs, and comes back by itself", "[trigger link]") {
  Bench bench;
  capture::TriggerLink link({.tty = bench.tty});
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  bench.board->mute(true);
  const auto request = link.abort();
  REQUIRE_FALSE(request);
  CHECK(request.error().code == ResultCode::kTriggerLost);
  REQUIRE(eventually([&] { return !link.connected(); }));
  CHECK_FALSE(link.inputs().known);
  CHECK_FALSE(link.inputs().belt_stopped);
  CHECK(link.last_error().code == ResultCode::kTriggerLost);
  bench.board->mute(false);
  REQUIRE(eventually([&] { return link.connected(); }));
  CHECK(link.abort());
}

TEST_CASE("a line over which nothing comes whole is noisy, not lost, and comes back by itself", "[trigger link]") {
  Bench bench;
  capture::TriggerLink link({.tty = bench.tty});
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  const auto armed = link.arm(Bench::sequence(500));
  REQUIRE(armed);
  REQUIRE(link.start_sequence(*armed));
  bench.board->set_noise(0.5);
  REQUIRE(eventually([&] { return !link.connected(); }));
  CHECK(link.last_error().code == ResultCode::kTriggerLineNoisy);
  bench.board->set_noise(0.0);
  REQUIRE(eventually([&] { return link.connected(); }));
  CHECK(link.abort());
}

TEST_CASE("a board that was powered off is found again at its new tty", "[trigger link]") {
  Bench bench;
  capture::TriggerLink link({.tty = bench.tty});
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  bench.board.reset();
  REQUIRE(eventually([&] { return !link.connected(); }));
  bench.power_up();
  REQUIRE(eventually([&] { return link.connected(); }));
  CHECK(link.arm(Bench::sequence(3)));
}

TEST_CASE("a tty that is not there is told, and stopping does not wait for it", "[trigger link]") {
  capture::TriggerLink link({.tty = "/dev/no-such-tty"});
  link.start();
  REQUIRE(eventually([&] { return link.last_error().text().find("No such file") != std::string_view::npos; }));
  CHECK(link.last_error().code == ResultCode::kTriggerLost);
  CHECK(link.arm(Bench::sequence(3)).error().code == ResultCode::kTriggerLost);
}

TEST_CASE("the firmware's identity is known, and a second program is told that the tty is taken", "[trigger link]") {
  Bench bench;
  capture::TriggerLink link({.tty = bench.tty});
  CHECK_FALSE(link.tried());
  CHECK_FALSE(link.identity());
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  CHECK(link.tried());
  REQUIRE(link.identity());
  CHECK(link.identity()->board == protocol::BoardKind::kHost);

  capture::TriggerLink second({.tty = bench.tty});
  second.start();
  REQUIRE(eventually([&] { return second.tried(); }));
  CHECK(second.last_error().text().find("another program uses it") != std::string_view::npos);
  CHECK(link.connected());
}

TEST_CASE("a firmware of another protocol version is told from a silent one", "[trigger link]") {
  const int board = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  REQUIRE(board >= 0);
  REQUIRE(::grantpt(board) == 0);
  REQUIRE(::unlockpt(board) == 0);
  capture::TriggerLink link({.tty = ::ptsname(board)});
  link.start();
  std::uint8_t frame[protocol::kMaxFrame];
  const std::uint8_t message[] = {protocol::kVersion + 1, static_cast<std::uint8_t>(protocol::Type::kIdentity), 1};
  const std::size_t size = protocol::encode_frame(message, sizeof message, frame, sizeof frame);
  REQUIRE(eventually([&] {
    (void)!::write(board, frame, size);
    std::uint8_t asked[64];
    while (::read(board, asked, sizeof asked) > 0) {
    }
    return link.tried() && link.last_error().text().find("flash the matching firmware") != std::string_view::npos;
  }));
  CHECK(link.last_error().text().find("expected protocol version 2, found 3") != std::string_view::npos);
  ::close(board);
}

TEST_CASE("firmware faults have codes of their own, or the appliance's where it has one", "[trigger link]") {
  CHECK(static_cast<int>(capture::code_of(protocol::Fault::kStrobeMissing)) == 201);
  CHECK(capture::code_of(protocol::Fault::kBeltMoved) == ResultCode::kBeltMovedDuringCapture);
  CHECK(capture::code_of(protocol::Fault::kEmergencyStop) == ResultCode::kEmergencyStop);
}
