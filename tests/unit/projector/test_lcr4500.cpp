#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <thread>

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "projector/lcr4500_projector.hpp"
#include "support/dlpc350/gadget.hpp"

using namespace beltpick;
using namespace beltpick::projector;
using test::Dlpc350Gadget;

namespace {

// The driver at one end of a socket, the gadget at the other, in a thread of its own.
struct Bench {
  Bench() {
    std::signal(SIGPIPE, SIG_IGN);
    REQUIRE(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends) == 0);
    projector.emplace(Lcr4500Config{.first_image = 3}, HidChannel(ends[0]));
    thread = std::thread([this] { serve(); });
  }
  ~Bench() {
    stop = true;
    thread.join();
    unplug();
  }
  void unplug() {
    if (ends[1] >= 0) ::close(std::exchange(ends[1], -1));
  }
  void serve() {
    while (!stop) {
      std::array<std::uint8_t, 65> in{};
      if (::read(ends[1], in.data(), in.size()) != 65) {
        std::this_thread::yield();
        continue;
      }
      Dlpc350Gadget::Bytes report{}, reply{};
      std::copy(in.begin() + 1, in.end(), report.begin());
      if (gadget.take(report, reply) && ::write(ends[1], reply.data(), reply.size()) < 0) return;
    }
  }

  int ends[2]{-1, -1};
  Dlpc350Gadget gadget;  // touched here only while the driver waits for nothing
  std::optional<Lcr4500Projector> projector;
  std::atomic<bool> stop{false};
  std::thread thread;
};

ShowPlan plan_of(SequenceName name, double exposure_us = 9000) {
  ShowPlan plan;
  plan.sequence =
      make_sequence(name, {lcr4500::kWidth, lcr4500::kHeight, ProjectorLayout::kDiamond}, SequenceAxes::kColumn)
          .value();
  for (FrameSpec& frame : plan.sequence.frames) frame.exposure_us = exposure_us;
  plan.settle_us = 1000;
  plan.shortest_period_us = 21'000;
  return plan;
}

}  // namespace

TEST_CASE("Every edge shows the next frame's bit planes, and a start begins anew", "[lcr4500]") {
  const SequenceName name = GENERATE(SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust);
  Bench bench;
  const ShowPlan plan = plan_of(name);
  const auto prepared = bench.projector->prepare(plan);
  INFO((prepared ? "" : prepared.error().detail));
  REQUIRE(prepared);
  const auto flash = lcr4500::plan_flash(plan.sequence);
  CHECK(bench.gadget.mode == 1);
  CHECK(bench.gadget.source == 3);
  CHECK(bench.gadget.trigger == 1);
  CHECK(bench.gadget.exposure_us == 8800);
  CHECK(bench.gadget.period_us == 9030);
  CHECK(bench.gadget.trigger_delay == 10261);  // 1100 us in units of 107.2 ns
  CHECK_FALSE(bench.gadget.running);
  CHECK(bench.projector->facts().firmware == "4.0.0");
  for (int round = 0; round < 2; ++round) {
    REQUIRE(bench.projector->start());
    CHECK(bench.projector->check());
    const std::size_t frames = round == 0 ? 5 : flash->places.size();  // the first round breaks off
    for (std::size_t i = 0; i < frames; ++i) {
      const auto shown = bench.gadget.edge();
      INFO("frame " << i);
      CHECK(shown.image == 3 + flash->places[i].image);
      CHECK(shown.first_plane == flash->places[i].first_plane);
      CHECK(shown.bits == flash->places[i].bits);
    }
  }
  REQUIRE(bench.projector->stop());
  CHECK_FALSE(bench.gadget.running);
}

TEST_CASE("What the device does wrong has a code of its own, and a line with the command", "[lcr4500]") {
  struct Case {
    Dlpc350Gadget::Break breaks;
    ResultCode code;
  };
  const Case wrong = GENERATE(Case{Dlpc350Gadget::Break::kRefuse, ResultCode::kProjectorRefused},
                              Case{Dlpc350Gadget::Break::kSilent, ResultCode::kProjectorSilent},
                              Case{Dlpc350Gadget::Break::kOtherSequence, ResultCode::kProjectorWrongReply});
  const int command = GENERATE(0x1A31, 0x1A34, 0x1A29);
  Bench bench;
  bench.gadget.breaks = wrong.breaks;
  bench.gadget.breaks_command = command;
  const auto prepared = bench.projector->prepare(plan_of(SequenceName::kFast));
  REQUIRE_FALSE(prepared);
  INFO(prepared.error().detail);
  CHECK(prepared.error().code == wrong.code);
  char name[16];
  std::snprintf(name, sizeof name, "0x%04X", static_cast<unsigned>(command));
  CHECK(prepared.error().text().find(name) != std::string_view::npos);
}

TEST_CASE("A reply that is too short, a device that is gone, old firmware, missing images", "[lcr4500]") {
  Bench bench;
  const ShowPlan plan = plan_of(SequenceName::kFast);
  SECTION("short") {
    bench.gadget.breaks = Dlpc350Gadget::Break::kShort;
    bench.gadget.breaks_command = 0x0205;
    CHECK(bench.projector->prepare(plan).error().code == ResultCode::kProjectorWrongReply);
  }
  SECTION("gone") {
    REQUIRE(bench.projector->prepare(plan));
    bench.stop = true;
    bench.thread.join();
    bench.thread = std::thread([] {});
    bench.unplug();
    CHECK(bench.projector->start().error().code == ResultCode::kProjectorLost);
    CHECK(bench.projector->check().error().code == ResultCode::kProjectorLost);
  }
  SECTION("old") {
    bench.gadget.version = {0, 0, 1, 2};
    const auto prepared = bench.projector->prepare(plan);
    CHECK(prepared.error().code == ResultCode::kVersionUnsupported);
    CHECK(prepared.error().text().find("2.1.0") != std::string_view::npos);
  }
  SECTION("images") {
    bench.gadget.images_in_flash = 4;
    const auto prepared = bench.projector->prepare(plan);
    CHECK(prepared.error().code == ResultCode::kProjectorRefused);
    CHECK(prepared.error().text().find("found 4 images") != std::string_view::npos);
  }
}

TEST_CASE("What the controller's own checks find is named", "[lcr4500]") {
  Bench bench;
  const ShowPlan plan = plan_of(SequenceName::kFast);
  REQUIRE(bench.projector->prepare(plan));
  bench.gadget.hardware_bits = 0x01 | 0x08 | 0x80;
  const auto bad = bench.projector->check();
  REQUIRE_FALSE(bad);
  CHECK(bad.error().code == ResultCode::kProjectorFault);
  CHECK(bad.error().text().find("an image was not loaded in time, sequencer error") != std::string_view::npos);
  bench.gadget.hardware_bits = 0x00;
  CHECK(bench.projector->check().error().text().find("initialisation") != std::string_view::npos);
  bench.gadget.hardware_bits = 0x01;
  REQUIRE(bench.projector->start());
  bench.gadget.running = false;
  CHECK(bench.projector->check().error().text().find("sequence was stopped") != std::string_view::npos);
}

TEST_CASE("A failed validation names its bits", "[lcr4500]") {
  int ends[2];
  REQUIRE(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends) == 0);
  Dlpc350 dlpc{HidChannel(ends[0])};
  std::thread device([&] {
    for (std::uint8_t i = 1; i <= 2; ++i) {
      std::array<std::uint8_t, 65> in{};
      while (::read(ends[1], in.data(), in.size()) != 65) std::this_thread::yield();
      const std::array<std::uint8_t, 64> reply{in[1], i, 1, 0, 0x01 | 0x10};
      CHECK(::write(ends[1], reply.data(), reply.size()) == 64);
    }
  });
  const auto validated = dlpc.validate(1000);
  device.join();
  ::close(ends[1]);
  REQUIRE_FALSE(validated);
  CHECK(validated.error().code == ResultCode::kProjectorRefused);
  CHECK(validated.error().text().find("exposure or frame period out of range, frame period less than 230 us") !=
        std::string_view::npos);
}

TEST_CASE("Timings that the projector cannot keep are refused with what the recipe needs", "[lcr4500]") {
  ShowPlan plan = plan_of(SequenceName::kFast);
  const auto timing = plan_timing(plan);
  REQUIRE(timing);
  // The light begins after the camera's exposure and ends before it.
  CHECK(timing->delay_us > plan.settle_us);
  CHECK(timing->delay_us + timing->exposure_us < plan.settle_us + 9000);
  plan.shortest_period_us = timing->delay_us + timing->period_us;
  CHECK(plan_timing(plan));
  plan.shortest_period_us -= 1;
  const auto tight = plan_timing(plan);
  REQUIRE_FALSE(tight);
  CHECK(tight.error().code == ResultCode::kValueOutOfRange);
  CHECK(tight.error().text().find("period_us: expected at least 10130") != std::string_view::npos);
  const auto dim = plan_timing(plan_of(SequenceName::kFast, 8000));
  REQUIRE_FALSE(dim);
  CHECK(dim.error().text().find("exposure_us: expected at least 8533") != std::string_view::npos);
  plan = plan_of(SequenceName::kFast);
  plan.sequence.frames[3].exposure_us = 20'000;
  CHECK(plan_timing(plan).error().text().find("frame 3") != std::string_view::npos);
}
