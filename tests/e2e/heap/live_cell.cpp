#include "live_cell.hpp"

#include <arpa/inet.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <thread>

#include "base/clock.hpp"

namespace live {

namespace fs = std::filesystem;
using beltpick::Stopwatch;

namespace {

// A loopback address of this run's own, so that two runs do not share a camera.
std::string camera_address() {
  const int run = getpid() % 62000;
  return "127.0." + std::to_string(10 + run / 250 % 240) + "." + std::to_string(1 + run % 250);
}

void pause_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

}  // namespace

fs::path cell_folder() { return BELTPICK_E2E_CELL; }

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

VirtualCell::VirtualCell(const fs::path& run, std::uint16_t plc_port, int parts, int seed, int speed)
    : report_(run / "report.json") {
  const std::string beltpick = BELTPICK_BIN_DIR "/beltpick";
  std::vector<std::string> words{beltpick,
                                 "simulate",
                                 "--live",
                                 "--rig",
                                 cell_folder() / "rig.toml",
                                 "--part",
                                 "knuckle",
                                 "--parts",
                                 std::to_string(parts),
                                 "--seed",
                                 std::to_string(seed),
                                 "--speed",
                                 std::to_string(speed),
                                 "--sequence",
                                 cell_folder() / "sequence.json",
                                 "--plc",
                                 "127.0.0.1:" + std::to_string(plc_port),
                                 "--camera-address",
                                 camera_address(),
                                 "--trigger",
                                 run / "trigger",
                                 "--report",
                                 report_,
                                 "--linger",
                                 "60"};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  REQUIRE(posix_spawn(&process_, beltpick.c_str(), nullptr, nullptr, arguments.data(), environ) == 0);
  for (int i = 0; i < 600 && !fs::exists(run / "trigger"); ++i) pause_ms(50);
  REQUIRE(fs::exists(run / "trigger"));
}

VirtualCell::~VirtualCell() {
  if (process_ == 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

nlohmann::json VirtualCell::wait_report(double patience_s) const {
  const Stopwatch watch;
  while (!fs::exists(report_) && watch.elapsed_ms() < patience_s * 1000) pause_ms(50);
  std::ifstream file(report_);
  return file ? nlohmann::json::parse(file) : nlohmann::json();
}

nlohmann::json VirtualCell::stop() {
  kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
  process_ = 0;
  return wait_report(0);
}

beltpick::app::Settings settings_for(const fs::path& run, std::uint16_t plc_port) {
  beltpick::app::Settings settings;
  settings.folder = cell_folder();
  settings.camera_id = camera_address();
  settings.trigger_tty = run / "trigger";
  settings.strobe_tolerance_us = 2000;
  settings.plc_address = "127.0.0.1";
  settings.plc_port = plc_port;
  settings.limits.image_width = 640;
  settings.limits.image_height = 480;
  return settings;
}

RunningAppliance::TermBlocked::TermBlocked() {
  sigset_t term;
  sigemptyset(&term);
  sigaddset(&term, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &term, nullptr);
}

RunningAppliance::RunningAppliance(const beltpick::app::Settings& settings) : appliance_(settings, log_) {
  const auto opened = appliance_.open_state(beltpick::app::Appliance::State::kKeep);
  INFO((opened ? "" : opened.error().detail));
  REQUIRE(opened);
  const auto loaded = appliance_.load();
  INFO((loaded ? "" : loaded.error().detail));
  REQUIRE(loaded);
  supervisor_ = std::thread([this] { exit_code_ = appliance_.run().value_or(-2); });
  pthread_setname_np(supervisor_.native_handle(), "supervisor");
  pthread_setname_np(pthread_self(), "test");
}

int RunningAppliance::stop() {
  kill(getpid(), SIGTERM);
  supervisor_.join();
  return exit_code_;
}

bool wait_for_cycles(const beltpick::app::Appliance& appliance, int cycles, double patience_s) {
  const Stopwatch watch;
  while (appliance.book().counts().cycles < cycles) {
    if (watch.elapsed_ms() > patience_s * 1000) return false;
    pause_ms(20);
  }
  return true;
}

void check_counted_threads(const std::vector<heap::ThreadCount>& counts) {
  for (const std::string must_live : {"vision", "pose", "cycle", "plc", "supervisor", "trigger", "aravis-stream"}) {
    INFO(must_live);
    CHECK(std::any_of(counts.begin(), counts.end(), [&](const auto& count) { return count.thread == must_live; }));
  }
  for (const heap::ThreadCount& count : counts) {
    const auto& name = count.thread;
    std::printf("  %-16s %7ld taken %7ld given back\n", name.c_str(), count.taken, count.given_back);
    CAPTURE(name, count.taken, count.given_back);
    const bool counted = name == "vision" || name == "pose" || name == "cycle" || name == "plc" ||
                         name == "supervisor" || name == "trigger";
    if (counted) CHECK(count.taken == 0);
  }
}

}  // namespace live
