// Twenty cycles of the whole appliance, with the real camera interface, trigger link, pipeline and Modbus server beside
// the virtual cell: the threads of the design allocate nothing, the others little; then a stop in the midst of work.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>

#include "base/clock.hpp"
#include "live_cell.hpp"

using namespace beltpick;
namespace fs = std::filesystem;

namespace {

constexpr int kCycles = 20;

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
  const fs::path run = fs::temp_directory_path() / ("beltpick_heap_" + std::to_string(getpid()));
  fs::create_directories(run);
  const std::uint16_t port = live::free_port();
  live::VirtualCell world(run, port, 72, 5, 20);
  const app::Settings settings = live::settings_for(run, port);

  live::RunningAppliance appliance(settings);

  // The first cycle is the start: each thread sets up what it keeps.
  const bool began = live::wait_for_cycles(*appliance, 2, 60);
  heap::start();
  const bool done = began && live::wait_for_cycles(*appliance, 2 + kCycles, 120);
  heap::stop();
  const auto counts = heap::counts();
  const app::RunBook::Totals totals = appliance.book().totals();

  const Stopwatch stopping;
  CHECK(appliance.stop() == 0);
  CHECK(stopping.elapsed_ms() < 2000);
  const auto report = world.stop();
  fs::remove_all(run);

  REQUIRE(done);
  CHECK(totals.offers > kCycles);
  REQUIRE(report.is_object());
  CHECK(report["crashes"] == 0);
  live::check_counted_threads(counts);
  for (const heap::ThreadCount& count : counts) {
    const auto& name = count.thread;
    CAPTURE(name, count.taken, count.given_back);
    if (name == "aravis-stream") {
      // Two blocks a frame, given back when the frame is whole.
      CHECK(count.taken <= 3L * totals.captures * settings.limits.frames);
      CHECK(std::abs(count.taken - count.given_back) < 20);
    } else if (name == "service") {
      CHECK(count.taken <= 20L * kCycles);
    }
  }
}
