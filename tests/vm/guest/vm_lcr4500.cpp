// The LightCrafter 4500 driver over a real /dev/hidraw: the gadget at the other end of the simulated USB cable is a
// DLPC350 of our own, served here in a thread. guest/lcr4500.sh plugs it together.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <thread>

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "projector/lcr4500_projector.hpp"
#include "projector/projector_keeper.hpp"
#include "support/dlpc350/gadget.hpp"

using namespace beltpick;
using namespace beltpick::projector;
using test::Dlpc350Gadget;

namespace {

const std::atomic<ResultCode> kGoOn{ResultCode::kOk};
constexpr const char* kUdc = "/sys/kernel/config/usb_gadget/dlpc350/UDC";

template <class Condition>
bool wait_until(Condition condition, int timeout_ms = 8000) {
  for (int i = 0; i < timeout_ms / 10 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

bool there() { return !find_hidraw(0x0451, 0x6401).empty(); }

void plug() {
  std::ofstream(kUdc) << "dummy_udc.0\n";
  REQUIRE(wait_until([] { return there() && ::access(find_hidraw(0x0451, 0x6401).c_str(), R_OK | W_OK) == 0; }));
}

void unplug() {
  std::ofstream(kUdc) << "\n";
  REQUIRE(wait_until([] { return !there(); }));
}

// The device's side of the cable, from plugging it in to pulling it.
struct Device {
  Device() {
    plug();
    serve();
  }
  ~Device() {
    rest();
    if (there()) unplug();
  }
  void serve() {
    stop = false;
    thread = std::thread([this] {
      const int fd = ::open("/dev/hidg0", O_RDWR | O_CLOEXEC | O_NONBLOCK);
      while (!stop) {
        pollfd waiting{fd, POLLIN, 0};
        Dlpc350Gadget::Bytes report{}, reply{};
        if (::poll(&waiting, 1, 20) <= 0 || ::read(fd, report.data(), report.size()) != 64) continue;
        if (gadget.take(report, reply)) send(fd, reply);
      }
      ::close(fd);
    });
  }
  // A reply that nobody fetches any more, because the cable was pulled, would block for ever.
  void send(int fd, const Dlpc350Gadget::Bytes& reply) {
    while (!stop && ::write(fd, reply.data(), reply.size()) < 0 && errno == EAGAIN) {
      pollfd waiting{fd, POLLOUT, 0};
      ::poll(&waiting, 1, 20);
    }
  }
  void rest() {
    stop = true;
    if (thread.joinable()) thread.join();
  }

  Dlpc350Gadget gadget;
  std::atomic<bool> stop{false};
  std::thread thread;
};

ShowPlan plan_of(SequenceName name) {
  ShowPlan plan;
  plan.sequence =
      make_sequence(name, {lcr4500::kWidth, lcr4500::kHeight, ProjectorLayout::kDiamond}, SequenceAxes::kColumn)
          .value();
  for (FrameSpec& frame : plan.sequence.frames) frame.exposure_us = 9000;
  plan.settle_us = 1000;
  plan.shortest_period_us = 21'000;
  return plan;
}

}  // namespace

TEST_CASE("The whole command set over hidraw: set up, validated, started, every edge the next pattern") {
  Device device;
  Lcr4500Projector projector({});
  const ShowPlan plan = plan_of(SequenceName::kRobust);  // its pattern table takes two reports
  const auto prepared = projector.prepare(plan);
  INFO((prepared ? "" : prepared.error().detail));
  REQUIRE(prepared);
  REQUIRE(projector.start());
  REQUIRE(projector.check());
  CHECK(projector.facts().device.starts_with("/dev/hidraw"));
  CHECK(projector.facts().firmware == "4.0.0");
  device.rest();
  const auto flash = lcr4500::plan_flash(plan.sequence);
  for (const FlashPlace& place : flash->places) {
    const auto shown = device.gadget.edge();
    CHECK(shown.image == place.image);
    CHECK(shown.first_plane == place.first_plane);
    CHECK(shown.bits == place.bits);
  }
  for (const int command : {0x0205, 0x1A42, 0x1A24, 0x1A1B, 0x1A22, 0x1A31, 0x1A23, 0x1A29, 0x1A35, 0x1A33, 0x1A32,
                            0x1A34, 0x1A1A, 0x1A0A, 0x1A0C}) {
    INFO("command " << std::hex << command);
    CHECK(std::count(device.gadget.commands.begin(), device.gadget.commands.end(), command) > 0);
  }
}

TEST_CASE("Refused, silent, answered wrongly: each has its own code and line") {
  struct Case {
    Dlpc350Gadget::Break breaks;
    int command;
    ResultCode code;
    const char* words;
  };
  const Case wrong = GENERATE(
      Case{Dlpc350Gadget::Break::kRefuse, 0x1A31, ResultCode::kProjectorRefused, "refused command 0x1A31"},
      Case{Dlpc350Gadget::Break::kSilent, 0x1A29, ResultCode::kProjectorSilent, "expected a reply within 1000 ms"},
      Case{Dlpc350Gadget::Break::kOtherSequence, 0x1A34, ResultCode::kProjectorWrongReply, "expected the reply 40"},
      Case{Dlpc350Gadget::Break::kShort, 0x0205, ResultCode::kProjectorWrongReply, "expected at least 16 bytes"});
  Device device;
  device.gadget.breaks = wrong.breaks;
  device.gadget.breaks_command = wrong.command;
  Lcr4500Projector projector({});
  const auto prepared = projector.prepare(plan_of(SequenceName::kFast));
  REQUIRE_FALSE(prepared);
  std::printf("%.*s: %s\n", static_cast<int>(result_code_name(prepared.error().code).size()),
              result_code_name(prepared.error().code).data(), prepared.error().detail);
  CHECK(prepared.error().code == wrong.code);
  CHECK(prepared.error().text().find(wrong.words) != std::string_view::npos);
}

TEST_CASE("A projector that is pulled out is missed, and found again when it is back") {
  ProjectorKeeper keeper(std::make_unique<Lcr4500Projector>(Lcr4500Config{}));
  keeper.use(plan_of(SequenceName::kFast));
  keeper.start();
  REQUIRE(wait_until([&] { return keeper.tried(); }));
  CHECK(keeper.code() == ResultCode::kProjectorLost);
  CHECK(keeper.last_error().text().find("found none") != std::string_view::npos);
  {
    Device device;
    REQUIRE(wait_until([&] { return keeper.code() == ResultCode::kOk; }));
    REQUIRE(keeper.begin(5000, kGoOn));
    REQUIRE(keeper.end(false));
    unplug();
    REQUIRE(wait_until([&] { return keeper.code() == ResultCode::kProjectorLost; }));
    std::printf("%s\n", keeper.last_error().detail);
    CHECK(keeper.begin(100, kGoOn).error().code == ResultCode::kProjectorLost);
    device.rest();
  }
  Device device;
  REQUIRE(wait_until([&] { return keeper.code() == ResultCode::kOk; }));
  REQUIRE(keeper.begin(5000, kGoOn));
  REQUIRE(keeper.end(false));
}
