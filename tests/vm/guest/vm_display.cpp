// Page flips on a real display driver (vkms, the kernel's virtual one): what it shows is confirmed by the CRC that it
// computes of every frame, against one computed here from the pattern. guest/display.sh runs it.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "projector/drm_projector.hpp"

using namespace beltpick;
using namespace beltpick::projector;

namespace {

constexpr int kWidth = 640, kHeight = 480;

// CRC-32 of IEEE 802.3, reflected, from 0 and not inverted: the kernel's crc32_le().
std::uint32_t crc32_le(std::uint32_t crc, const std::vector<std::uint16_t>& words) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      made[i] = i;
      for (int bit = 0; bit < 8; ++bit) made[i] = (made[i] & 1U) != 0 ? made[i] >> 1U ^ 0xEDB88320U : made[i] >> 1U;
    }
    return made;
  }();
  for (const std::uint16_t word : words) {
    crc = crc >> 8U ^ table[(crc ^ word) & 0xFFU];
    crc = crc >> 8U ^ table[(crc ^ static_cast<std::uint32_t>(word >> 8U)) & 0xFFU];
  }
  return crc;
}

// Where a level lies half way between two, the last bit of a cosine decides: so the formula is the contract's own,
// which other tests check.
int level(const FrameSpec& frame, int row, int column) {
  return static_cast<int>(255.0 * pattern_intensity(frame, frame.axis == Axis::kColumn ? column : row) + 0.5);
}

// vkms takes the CRC of every line as it composes it: 16 bits each of opacity, red, green, blue.
std::uint32_t expected_crc(const FrameSpec& frame) {
  std::uint32_t crc = 0;
  std::vector<std::uint16_t> line(4 * kWidth);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const auto grey = static_cast<std::uint16_t>(257 * level(frame, row, column));
      std::uint16_t* pixel = &line[static_cast<std::size_t>(4 * column)];
      pixel[0] = 0xFFFF;
      pixel[1] = pixel[2] = pixel[3] = grey;
    }
    crc = crc32_le(crc, line);
  }
  return crc;
}

// The display's own CRCs, one a frame, as debugfs gives them: "0xFRAME 0xCRC\n".
class CrcReader {
 public:
  CrcReader() {
    std::ofstream(kFolder + "control") << "auto";
    fd_ = ::open((kFolder + "data").c_str(), O_RDONLY | O_NONBLOCK);
    REQUIRE(fd_ >= 0);
  }
  ~CrcReader() { ::close(fd_); }
  // Of the next frame that the display composes.
  std::uint32_t next() {
    for (;;) {
      pollfd waiting{fd_, POLLIN, 0};
      REQUIRE(::poll(&waiting, 1, 5000) == 1);
      std::array<char, 64> line{};
      if (::read(fd_, line.data(), line.size() - 1) <= 0) continue;
      unsigned frame = 0, crc = 0;
      if (std::sscanf(line.data(), "%x %x", &frame, &crc) == 2) return crc;
    }
  }
  // The driver composes in a thread of its own, and on a slow machine tells one composition's CRC for many frames.
  bool becomes(std::uint32_t expected) {
    const std::int64_t until_us = monotonic_us() + 5'000'000;
    while (monotonic_us() < until_us) {
      if (next() == expected) return true;
    }
    return false;
  }
  void skip_old() {
    std::array<char, 64> line{};
    while (::read(fd_, line.data(), line.size()) > 0) {
    }
  }

 private:
  const std::string kFolder = "/sys/kernel/debug/dri/0/crtc-0/crc/";
  int fd_ = -1;
};

ShowPlan plan_of(int width, int height) {
  ShowPlan plan;
  plan.sequence = make_sequence(SequenceName::kFast, {width, height}, SequenceAxes::kBoth).value();
  return plan;
}

}  // namespace

TEST_CASE("Every page that is shown is on the display, pixel for pixel, by the display's own CRC") {
  DrmProjector projector({});
  const ShowPlan plan = plan_of(kWidth, kHeight);
  const auto prepared = projector.prepare(plan);
  INFO((prepared ? "" : prepared.error().detail));
  REQUIRE(prepared);
  std::printf("%s: %s\n", projector.facts().device.c_str(), projector.facts().details.c_str());
  CrcReader crcs;
  REQUIRE(projector.start());
  std::int64_t before_us = 0;
  std::set<std::uint32_t> seen;
  for (std::size_t i = 0; i < plan.sequence.frames.size(); ++i) {
    const auto shown_us = projector.show(static_cast<int>(i));
    REQUIRE(shown_us);
    CHECK(*shown_us > before_us);
    CHECK(*shown_us <= monotonic_us() + 1000);  // the same clock
    before_us = *shown_us;
    crcs.skip_old();
    const std::uint32_t expected = expected_crc(plan.sequence.frames[i]);
    INFO("frame " << i);
    REQUIRE(crcs.becomes(expected));
    CHECK(crcs.next() == expected);  // and it stays
    seen.insert(expected);
  }
  CHECK(seen.size() == plan.sequence.frames.size());
  REQUIRE(projector.check());
  REQUIRE(projector.stop());
  crcs.skip_old();
  FrameSpec black;
  black.kind = FrameKind::kBlack;
  CHECK(crcs.becomes(expected_crc(black)));
}

TEST_CASE("A display that is not there, or lacks the mode, is named with the remedy") {
  const auto refused = [](const DrmProjectorConfig& config, int width, int height, ResultCode code, const char* words) {
    DrmProjector projector(config);
    const auto prepared = projector.prepare(plan_of(width, height));
    REQUIRE_FALSE(prepared);
    std::printf("%s\n", prepared.error().detail);
    CHECK(prepared.error().code == code);
    CHECK(prepared.error().text().find(words) != std::string_view::npos);
    CHECK(projector.show(0).error().code == ResultCode::kProjectorLost);
  };
  refused({"/dev/dri/card9", ""}, kWidth, kHeight, ResultCode::kProjectorLost, "/dev/dri/card9");
  refused({"", "HDMI-A-7"}, kWidth, kHeight, ResultCode::kProjectorLost, "Virtual-1");
  refused({"", ""}, 912, 1140, ResultCode::kProjectorRefused, "1024x768");
  refused({"/dev/null", ""}, kWidth, kHeight, ResultCode::kProjectorRefused, "/dev/null");
}

TEST_CASE("Somebody else who holds the display is named") {
  DrmProjector first({}), second({});
  REQUIRE(first.prepare(plan_of(kWidth, kHeight)));
  const auto refused = second.prepare(plan_of(kWidth, kHeight));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ResultCode::kProjectorRefused);
  CHECK(refused.error().text().find("other program") != std::string_view::npos);
}
