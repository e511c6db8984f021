// Twenty cycles of the whole appliance, with the real camera interface, trigger link, pipeline and Modbus server beside
// the virtual cell: the threads of the design allocate nothing, the others little; then a stop in the midst of work.
#include <arpa/inet.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/appliance.hpp"
#include "base/clock.hpp"
#include "heap_counter.hpp"

using namespace beltpick;
namespace fs = std::filesystem;

namespace {

constexpr int kCycles = 20;

std::uint16_t free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  REQUIRE(bind(probe, reinterpret_cast<sockaddr*>(&at), size) == 0);
  REQUIRE(getsockname(probe, reinterpret_cast<sockaddr*>(&at), &size) == 0);
  close(probe);
  return ntohs(at.sin_port);
}

// `beltpick simulate --live` as a process of its own.
class VirtualCell {
 public:
  VirtualCell(const fs::path& cell, const fs::path& run, std::uint16_t port) {
    const std::string beltpick = BELTPICK_BIN_DIR "/beltpick";
    std::vector<std::string> words{beltpick,
                                   "simulate",
                                   "--live",
                                   "--rig",
                                   cell / "rig.toml",
                                   "--part",
                                   "knuckle",
                                   "--parts",
                                   "72",
                                   "--seed",
                                   "5",
                                   "--speed",
                                   "20",
                                   "--sequence",
                                   cell / "sequence.json",
                                   "--plc",
                                   "127.0.0.1:" + std::to_string(port),
                                   "--camera-address",
                                   kCamera,
                                   "--trigger",
                                   run / "trigger"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    REQUIRE(posix_spawn(&process_, beltpick.c_str(), nullptr, nullptr, arguments.data(), environ) == 0);
    for (int i = 0; i < 600 && !fs::exists(run / "trigger"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    REQUIRE(fs::exists(run / "trigger"));
  }
  ~VirtualCell() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  VirtualCell(const VirtualCell&) = delete;
  VirtualCell& operator=(const VirtualCell&) = delete;

  static constexpr const char* kCamera = "127.0.9.77";

 private:
  pid_t process_ = 0;
};

app::Settings settings_for(const fs::path& cell, const fs::path& run, std::uint16_t port) {
  app::Settings settings;
  settings.folder = cell;
  settings.camera_id = VirtualCell::kCamera;
  settings.trigger_tty = run / "trigger";
  settings.strobe_tolerance_us = 2000;
  settings.plc_address = "127.0.0.1";
  settings.plc_port = port;
  settings.limits.image_width = 640;
  settings.limits.image_height = 480;
  return settings;
}

bool wait_for_cycles(const app::Appliance& appliance, int cycles, double patience_s) {
  const Stopwatch watch;
  while (appliance.book().totals().cycles < cycles) {
    if (watch.elapsed_ms() > patience_s * 1000) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

}  // namespace

TEST_CASE("the counter sees what a thread takes, whichever way", "[heap]") {
  heap::start();
  std::free(std::malloc(7));
  auto number = std::make_unique<int>(7);
  std::vector<std::string> texts(3, std::string(100, 'x'));
  heap::stop();
  const auto counts = heap::counts();
  CHECK(std::any_of(counts.begin(), counts.end(), [](const auto& count) { return count.taken >= 6; }));
}

TEST_CASE("over twenty cycles the threads of the design take nothing from the heap; a stop is quick", "[heap]") {
  const fs::path cell = BELTPICK_E2E_CELL;
  const fs::path run = fs::temp_directory_path() / ("beltpick_heap_" + std::to_string(getpid()));
  fs::create_directories(run);
  const std::uint16_t port = free_port();
  const VirtualCell world(cell, run, port);
  const app::Settings settings = settings_for(cell, run, port);

  sigset_t term;
  sigemptyset(&term);
  sigaddset(&term, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &term, nullptr);
  app::Log log;
  app::Appliance appliance(settings, log);
  const auto loaded = appliance.load();
  INFO((loaded ? "" : loaded.error().detail));
  REQUIRE(loaded);
  int exit_code = -1;
  std::thread supervisor([&] { exit_code = appliance.run().value_or(-2); });
  pthread_setname_np(supervisor.native_handle(), "supervisor");
  pthread_setname_np(pthread_self(), "test");

  // The first cycle is the start: each thread sets up what it keeps.
  const bool began = wait_for_cycles(appliance, 2, 60);
  heap::start();
  const bool done = began && wait_for_cycles(appliance, 2 + kCycles, 120);
  heap::stop();
  const auto counts = heap::counts();
  const app::RunBook::Totals totals = appliance.book().totals();

  const Stopwatch stopping;
  kill(getpid(), SIGTERM);
  supervisor.join();
  CHECK(stopping.elapsed_ms() < 2000);
  CHECK(exit_code == 0);
  fs::remove_all(run);

  REQUIRE(done);
  CHECK(totals.offers > kCycles);
  for (const std::string must_live : {"vision", "pose", "cycle", "plc", "supervisor", "trigger", "aravis-stream"}) {
    INFO(must_live);
    CHECK(std::any_of(counts.begin(), counts.end(), [&](const auto& count) { return count.thread == must_live; }));
  }
  for (const heap::ThreadCount& count : counts) {
    const auto& name = count.thread;
    std::printf("  %-16s %7ld taken %7ld given back\n", name.c_str(), count.taken, count.given_back);
    CAPTURE(name, count.taken, count.given_back);
    if (name == "vision" || name == "pose" || name == "cycle" || name == "plc" || name == "supervisor" ||
        name == "trigger") {
      CHECK(count.taken == 0);
    } else if (name == "aravis-stream") {
      // Two blocks a frame, given back when the frame is whole.
      CHECK(count.taken <= 3L * totals.captures * settings.limits.frames);
      CHECK(std::abs(count.taken - count.given_back) < 20);
    } else if (name == "service") {
      CHECK(count.taken <= 20L * kCycles);
    }
  }
}
