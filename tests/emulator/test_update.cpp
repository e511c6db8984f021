// The field update's rehearsal: `beltpick flash` and the real avrdude against the real boot loader and firmware, whole
// and broken off. Every instant is chosen by a byte on the line. Most of the time is avrdude's waiting, so boards are
// rehearsed side by side.
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdio>
#include <future>
#include <random>
#include <thread>

#include "base/clock.hpp"
#include "emulator/flash_files.hpp"
#include "emulator/flashing.hpp"
#include "emulator/live_line.hpp"
#include "flash/peer.hpp"

using namespace emulator;
using beltpick::flash::Line;
using beltpick::flash::Peer;

namespace {

enum class Break { kKillAll, kKillAvrdude, kResetChip, kPowerCut, kCutLine, kNone };
constexpr const char* kBreaks[] = {"killed", "avrdude killed", "chip reset", "power cut", "line cut", "whole"};

constexpr int kOlderPatch = 9;  // of the firmware that is there before

const char* text_of(const std::optional<Peer>& peer) {
  if (!peer) return "nobody";
  if (peer->is_loader) return "the loader";
  return peer->identity.firmware_patch == kOlderPatch ? "the old firmware" : "the new firmware";
}

class Rehearsal {
 public:
  Rehearsal(Mcu mcu, const std::vector<std::string>& kinds)
      : mcu_(mcu), chip_(mcu, image_of(kinds, mcu)), line_(chip_) {
    const auto held = line_.hold();
    chip_.on_edge = [this](const PinEdge& edge) {
      const bool must_stay_low = edge.pin == Out::kCamera || edge.pin == Out::kProjector || edge.pin == Out::kBusy;
      if (must_stay_low && edge.level) ++rises_;
    };
  }

  [[nodiscard]] const std::string& tty() const { return line_.tty(); }
  [[nodiscard]] std::vector<std::string> arguments() const { return {hex_file("trigger", mcu_), "--port", tty()}; }

  // Lets it run up to that byte, then breaks it.
  void break_at(std::uint64_t byte, Break how, Flashing& flashing) {
    while (flashing.runs() && bytes_moved() < byte) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (how == Break::kKillAll) flashing.kill_all();
    if (how == Break::kKillAvrdude) flashing.kill_avrdude();
    if (how == Break::kCutLine) {
      mute(true);
      std::this_thread::sleep_for(std::chrono::milliseconds(700));
      mute(false);
    }
    const auto held = line_.hold();
    if (how == Break::kResetChip) chip_.reset_by_pin();
    if (how == Break::kPowerCut) chip_.power_cycle(static_cast<std::uint32_t>(byte));
  }

  // Who answers now.
  [[nodiscard]] std::optional<Peer> peer() const {
    const auto line = Line::open(tty());
    return line ? beltpick::flash::find_peer(*line, 6000) : std::nullopt;
  }

  // Empty when the new firmware runs, as flashed, the loader is what it was, and no output ever moved.
  std::string wrong() {
    const auto found = peer();
    const boot::FlashImage wanted = image_of({"boot", "trigger"}, mcu_);
    const boot::Record record = boot::find_record(wanted).record;
    if (!found || found->is_loader || found->identity.flash_crc != record.flash_crc ||
        found->identity.firmware_minor != record.minor || found->identity.firmware_patch != record.patch ||
        found->identity.flash_state != protocol::FlashState::kWhole) {
      return std::string("expected the new firmware, found ") + text_of(found);
    }
    const auto held = line_.hold();
    for (std::uint32_t at = 0; at < layout(mcu_).flash_bytes; ++at) {
      if (wanted.has(at) && chip_.flash_byte(at) != wanted.byte(at)) return "flash differs at " + std::to_string(at);
    }
    return rises_ == 0 ? "" : "an output rose";
  }

 private:
  std::uint64_t bytes_moved() {
    const auto held = line_.hold();
    return line_.live().bytes_moved();
  }
  void mute(bool muted) {
    const auto held = line_.hold();
    line_.live().mute(muted);
  }

  Mcu mcu_;
  Chip chip_;
  LiveLine line_;
  std::atomic<int> rises_{0};
};

struct Point {
  Mcu mcu;
  Break how;
  std::uint64_t byte;
};

struct Finding {
  std::string story;
  std::string wrong;  // empty: as it should be
};

// Breaks an update off; somebody must answer then, and a retry must succeed where the update itself did not.
Finding rehearse(Point point) {
  Rehearsal rehearsal(point.mcu, {"boot", "older"});
  const beltpick::Stopwatch watch;
  int code = -1;
  {
    Flashing flashing(rehearsal.arguments());
    if (point.how != Break::kNone) rehearsal.break_at(point.byte, point.how, flashing);
    code = flashing.outcome().exit_code;
  }
  const double seconds = watch.elapsed_ms() / 1000.0;
  const auto found = rehearsal.peer();
  Finding finding;
  char text[160];
  std::snprintf(text, sizeof text, "%s, %s at byte %5llu: exit %d after %.1f s, %s answers", layout(point.mcu).name,
                kBreaks[static_cast<int>(point.how)], static_cast<unsigned long long>(point.byte), code, seconds,
                text_of(found));
  finding.story = text;
  if (!found) finding.wrong = "nobody answers";
  if (finding.wrong.empty() && code != 0) {
    Flashing again(rehearsal.arguments());
    const auto outcome = again.outcome();
    finding.story += "; retried: exit " + std::to_string(outcome.exit_code);
    if (outcome.exit_code != 0) finding.wrong = outcome.err;
  }
  if (finding.wrong.empty()) finding.wrong = rehearsal.wrong();
  return finding;
}

// `at_once` boards side by side.
void rehearse_all(const std::vector<Point>& points, std::size_t at_once) {
  for (std::size_t first = 0; first < points.size(); first += at_once) {
    std::vector<std::future<Finding>> running;
    for (std::size_t i = first; i < std::min(points.size(), first + at_once); ++i) {
      running.push_back(std::async(std::launch::async, rehearse, points[i]));
    }
    for (auto& one : running) {
      const Finding finding = one.get();
      std::printf("%s\n", finding.story.c_str());
      CHECK(finding.wrong == "");
    }
  }
}

class Chance {
 public:
  explicit Chance(std::uint32_t seed) : random_(seed) {}

  // Any byte of an update: a firmware goes over the line twice, with a tenth more of requests and answers.
  Point point(Mcu mcu, Break how) {
    const std::uint64_t bytes = boot::find_record(image_of({"trigger"}, mcu)).record.length * std::uint64_t{22} / 10;
    return {mcu, how, std::uniform_int_distribution<std::uint64_t>(1, bytes)(random_)};
  }

 private:
  std::mt19937 random_;
};

}  // namespace

TEST_CASE("an update by the real avrdude, whole and broken off, ends with the new firmware", "[update]") {
  Chance chance(4);
  rehearse_all({{Mcu::kAtmega2560, Break::kNone, 0},
                {Mcu::kAtmega328p, Break::kNone, 0},
                chance.point(Mcu::kAtmega328p, Break::kKillAll),
                chance.point(Mcu::kAtmega328p, Break::kPowerCut),
                chance.point(Mcu::kAtmega2560, Break::kKillAvrdude)},
               5);
}

// By hand, some minutes: test_update_rehearsal "[twenty-points]".
TEST_CASE("an update of each board broken off at twenty random points", "[.][twenty-points]") {
  Chance chance(6);
  std::vector<Point> points;
  for (const Mcu mcu : {Mcu::kAtmega328p, Mcu::kAtmega2560}) {
    for (int i = 0; i < 20; ++i) points.push_back(chance.point(mcu, static_cast<Break>(i % 5)));
  }
  rehearse_all(points, 4);
}

TEST_CASE("an empty board takes its first firmware over the line", "[update]") {
  Rehearsal rehearsal(Mcu::kAtmega328p, {"boot"});
  Flashing flashing(rehearsal.arguments());
  const auto outcome = flashing.outcome();
  INFO(outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.err.find("the boot loader answers") != std::string::npos);
  CHECK(rehearsal.wrong() == "");
}

TEST_CASE("a board without our loader keeps its firmware, and is told how to get one", "[update]") {
  Rehearsal rehearsal(Mcu::kAtmega328p, {"older"});
  Flashing flashing(rehearsal.arguments());
  const auto outcome = flashing.outcome();
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.err.find("has no boot loader of beltpick's") != std::string::npos);
  const auto found = rehearsal.peer();
  REQUIRE(found);
  CHECK(std::string(text_of(found)) == "the old firmware");
}

TEST_CASE("what need not or must not be flashed is not", "[update]") {
  Rehearsal rehearsal(Mcu::kAtmega328p, {"boot", "older"});
  Flashing same({hex_file("older", Mcu::kAtmega328p), "--port", rehearsal.tty()});
  const auto outcome = same.outcome();
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out.find("already") != std::string::npos);
  Flashing other({hex_file("trigger", Mcu::kAtmega2560), "--port", rehearsal.tty()});
  const auto refused = other.outcome();
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("give trigger_atmega328p.hex") != std::string::npos);
  const auto held = Line::open(rehearsal.tty());
  REQUIRE(held.has_value());
  Flashing late(rehearsal.arguments());
  const auto busy = late.outcome();
  CHECK(busy.exit_code == 1);
  CHECK(busy.err.find("test_update") != std::string::npos);  // who holds it: this very program
}
