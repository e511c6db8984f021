// Phases and amplitudes that fringe components become in their own place.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "base/units.hpp"
#include "decode/phase_kernels.hpp"

namespace beltpick::decode {
namespace {

template <class Sum>
struct Components {
  std::vector<Sum> cosine, sine;
};

// All the way round at several lengths, and the axes, diagonals and nothing at all.
template <class Sum>
Components<Sum> all_round(double longest) {
  Components<Sum> all;
  const auto add = [&](double cosine, double sine) {
    all.cosine.push_back(static_cast<Sum>(std::lround(cosine)));
    all.sine.push_back(static_cast<Sum>(std::lround(sine)));
  };
  for (const double length : {1.0, 0.1, 0.01}) {
    for (int i = 0; i < 5000; ++i) {
      const double angle_rad = 2.0 * kPi * (i + 0.37) / 5000;
      add(longest * length * std::cos(angle_rad), longest * length * std::sin(angle_rad));
    }
  }
  for (const double sign : {1.0, -1.0}) {
    add(sign * longest, 0.0);
    add(0.0, sign * longest);
    add(sign * longest, longest);
    add(sign * longest, -longest);
  }
  add(0.0, 0.0);
  return all;
}

struct Worst {
  double turn = 0.0, amplitude = 0.0;  // the latter over the rounding to whole counts
};

template <class Sum>
Worst worst_of(double longest, float scale) {
  const Components<Sum> given = all_round<Sum>(longest);
  Components<Sum> made = given;
  const int count = static_cast<int>(given.cosine.size());
  phase_row(made.cosine.data(), made.sine.data(), count);
  std::vector<float> turn(given.cosine.size());
  std::vector<float> amplitude8(given.cosine.size());
  fringe_row(made.cosine.data(), made.sine.data(), count, scale, turn.data(), amplitude8.data());
  Worst worst;
  for (std::size_t i = 0; i < turn.size(); ++i) {
    const auto cosine = static_cast<double>(given.cosine[i]);
    const auto sine = static_cast<double>(given.sine[i]);
    const double length = std::hypot(cosine, sine);
    const double off = static_cast<double>(turn[i]) - std::atan2(sine, cosine) / (2.0 * kPi);
    if (length > 0.0) worst.turn = std::max(worst.turn, std::fabs(off - std::round(off)));
    worst.amplitude = std::max(worst.amplitude, std::fabs(static_cast<double>(amplitude8[i] / scale) - length));
  }
  return worst;
}

}  // namespace

TEST_CASE("phases of 8-bit cameras are right to a part of a turn, all the way round") {
  const Worst worst = worst_of<std::int16_t>(32600.0, 0.25F);
  CHECK(worst.turn < 0.7 / 65536.0);
  CHECK(worst.amplitude < 1.2);  // counts, of up to 46,000
}

TEST_CASE("phases of 16-bit cameras are right to a ten-millionth of a turn") {
  const Worst worst = worst_of<float>(65535.0, 1.0F);
  CHECK(worst.turn < 1e-7);
  CHECK(worst.amplitude < 0.01);
}

}  // namespace beltpick::decode
