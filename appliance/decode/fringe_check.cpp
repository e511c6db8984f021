// Whether the phase frames of a period form one fringe, and which mistake would explain it where they do not.
//
// What a set of images leaves unexplained under any assignment of phase shifts follows from how every two images vary
// together, so that all mistakes of one frame are tried at the cost of a few matrix products.
#include <algorithm>
#include <limits>

#include "contract/result_codes.hpp"
#include "decode/fringe_sums.hpp"

namespace beltpick::decode {
namespace {

constexpr int kLeastWitnesses = 200;
// A mistake explains the images where it leaves a quarter of what the declared order leaves, or less: gamma, sway and
// flicker leave as much under any order.
constexpr double kExplains = 0.25;
constexpr double kBeyondNoise = 4.0;  // times the variance of the noise that the declared order must leave
constexpr double kLeastLeft = 0.008;  // of all variation: neighbours of 16 steps exchanged leave 2 %
constexpr double kMostLeft = 0.3;     // of all variation; ripple of the projector's gamma leaves some percent

enum class Mistake : std::uint8_t { kNone, kExchanged, kAlien, kDropped };

struct Suspect {
  Mistake mistake = Mistake::kNone;
  std::size_t a = 0, b = 0;
  double left = std::numeric_limits<double>::infinity();  // a degree of freedom and witness, over the noise
};

// Images `image` (of `count`) taken for fringes of `shift_rad`.
struct Assignment {
  std::size_t count = 0;
  std::array<std::size_t, kMaxFringeFrames> image{};
  FrameVector shift_rad{};
};

double left_by(const FringeSums& sums, const Assignment& assignment) {
  if (assignment.count < 4) return std::numeric_limits<double>::infinity();  // three always fit
  const FrameMatrix left = unexplained(assignment.count, assignment.shift_rad);
  double sum = 0.0;
  for (std::size_t a = 0; a < assignment.count; ++a) {
    for (std::size_t b = 0; b < assignment.count; ++b) {
      sum += left[a][b] * sums.together[assignment.image[a]][assignment.image[b]];
    }
  }
  return sum / (static_cast<double>(sums.witnesses) * static_cast<double>(assignment.count - 3));
}

Assignment declared(const FringeSums& sums) {
  Assignment assignment{sums.frames, {}, sums.shift_rad};
  for (std::size_t n = 0; n < sums.frames; ++n) assignment.image[n] = n;
  return assignment;
}

// All images but the one at `which`, at their own shifts.
Assignment without(const FringeSums& sums, std::size_t which) {
  Assignment assignment;
  for (std::size_t n = 0; n < sums.frames; ++n) {
    if (n == which) continue;
    assignment.image[assignment.count] = n;
    assignment.shift_rad[assignment.count++] = sums.shift_rad[n];
  }
  return assignment;
}

// The frame `which` was not recorded: the images from there on belong one step later.
Assignment dropped(const FringeSums& sums, std::size_t which) {
  Assignment assignment;
  for (std::size_t n = 0; n + 1 < sums.frames; ++n) {
    assignment.image[assignment.count] = n;
    assignment.shift_rad[assignment.count++] = sums.shift_rad[n < which ? n : n + 1];
  }
  return assignment;
}

void keep_better(Suspect& best, const Suspect& other) {
  if (other.left < best.left) best = other;
}

// Of exchanges that explain as much, as an exchange and its mirror image do, neighbours are the likelier ones.
void keep_likelier(Suspect& best, const Suspect& other) {
  constexpr double kAsMuch = 1.5;
  const bool nearer = other.b - other.a < best.b - best.a;
  if (other.left < best.left / kAsMuch || (other.left < best.left * kAsMuch && nearer)) best = other;
}

Suspect find_suspect(const FringeSums& sums) {
  Suspect best;
  for (std::size_t a = 0; a < sums.frames; ++a) {
    for (std::size_t b = a + 1; b < sums.frames; ++b) {
      Assignment assignment = declared(sums);
      std::swap(assignment.image[a], assignment.image[b]);
      keep_likelier(best, {Mistake::kExchanged, a, b, left_by(sums, assignment)});
    }
  }
  // An exchange of the last two frames looks as if the first of them was dropped, and explains one image more.
  Suspect gap;
  for (std::size_t a = 0; a + 1 < sums.frames; ++a) {
    keep_better(gap, {Mistake::kDropped, a, a, left_by(sums, dropped(sums, a))});
  }
  if (gap.left < 0.5 * best.left) best = gap;
  // One alien frame: leaving it out must help much more than leaving out any other.
  Suspect alien;
  double second = alien.left;
  for (std::size_t n = 0; n < sums.frames; ++n) {
    const Suspect suspect{Mistake::kAlien, n, n, left_by(sums, without(sums, n))};
    second = std::min(second, std::max(suspect.left, alien.left));
    keep_better(alien, suspect);
  }
  // Of five frames less one, a single number is left to judge by, which is small by chance now and then.
  const double clearly = sums.frames > 5 ? kExplains : 0.2 * kExplains;
  if (alien.left < clearly * second && alien.left < clearly * best.left) best = alien;
  return best;
}

std::unexpected<Error> name_mistake(const ProbeLevels& levels, const FringeSums& sums, double period_px,
                                    const Suspect& suspect) {
  const char* a = levels.spec(sums.index[suspect.a]).file.c_str();
  const char* b = levels.spec(sums.index[suspect.b]).file.c_str();
  if (suspect.mistake == Mistake::kExchanged) {
    return failure(ResultCode::kSequenceOrderWrong, "the phase frames %s and %s (period %g px) look exchanged", a, b,
                   period_px);
  }
  if (suspect.mistake == Mistake::kDropped) {
    return failure(ResultCode::kFrameMissing,
                   "the frame of %s (period %g px) is missing: from there on every image shows the pattern after its "
                   "own; capture again, and look for dropped frames",
                   a, period_px);
  }
  return failure(ResultCode::kSequenceOrderWrong,
                 "%s does not show its phase step (period %g px), all others of the period do: it was exchanged with a "
                 "frame of another kind, or exposed otherwise%s",
                 a, period_px, suspect.a == 0 ? ", or every image shows the pattern before its own" : "");
}

}  // namespace

Result<void> check_fringe(const ProbeLevels& levels, int channel, const FringeSums& sums) {
  if (sums.frames < 4 || sums.witnesses < kLeastWitnesses) return {};  // three frames always fit
  const double period_px = levels.plan->channels[static_cast<std::size_t>(channel)].period_px;
  const double left = left_by(sums, declared(sums));
  if (left < kBeyondNoise) return {};
  double all = 0.0;
  for (std::size_t n = 0; n < sums.frames; ++n) all += sums.together[n][n];
  const double share = left * static_cast<double>(sums.witnesses) * static_cast<double>(sums.frames - 3) / all;
  if (share < kLeastLeft) return {};
  const Suspect suspect = find_suspect(sums);
  if (suspect.left < kExplains * left) return name_mistake(levels, sums, period_px, suspect);
  if (share < kMostLeft) return {};
  return failure(
      ResultCode::kSequenceOrderWrong,
      "the %zu phase frames of period %g px do not form one fringe in their declared order (%.0f %% of their "
      "variation is left over); check their steps, and whether a frame is missing or doubled",
      sums.frames, period_px, 100.0 * share);
}

}  // namespace beltpick::decode
