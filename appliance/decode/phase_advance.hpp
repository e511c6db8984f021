// How many periods of a fringe lie along a line: what is true of whole periods only is asked where there are some.
// Internal to decode.
#pragma once

#include <algorithm>
#include <cmath>

namespace beltpick::decode {

// Along some line across the image, fewer periods than this do not spread the phases evenly.
inline constexpr double kEvenlySpreadPeriods = 3.0;

// The range of the phase, in periods, along `count` pixels; turn_at(i) is pixel i's phase in turns, NaN where it is
// not known. Gaps do not count.
template <class TurnAt>
double periods_along(int count, TurnAt turn_at) {
  double advance = 0.0;
  double least = 0.0;
  double most = 0.0;
  double before = NAN;
  for (int i = 0; i < count; ++i) {
    const double turn = turn_at(i);
    const double step = turn - before;
    before = turn;
    if (std::isnan(step)) continue;
    advance += step - std::round(step);
    least = std::min(least, advance);
    most = std::max(most, advance);
  }
  return most - least;
}

}  // namespace beltpick::decode
