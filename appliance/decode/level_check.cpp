// Black and doubled frames.
#include <cmath>

#include "base/camera_noise.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "decode/frame_check.hpp"
#include "decode/fringe_sums.hpp"

namespace beltpick::decode {
namespace {

constexpr float kDarkShareOfContrast = 0.15F;
constexpr float kNearlyAll = 0.95F;
constexpr double kPartOfPeriod = 0.5;  // in view: may be all dark in one frame, and alike in two
// Two images of one pattern differ by noise, and by the flicker of the ambient light.
constexpr float kFlickerShare = 0.02F;
constexpr double kSameEnergy = 3.0;
// Different patterns must be expected to differ this much more than images of the same one may.
constexpr double kTellingEnergy = 4.0;

float bright_share(const ProbeLevels& levels, int frame) {
  const Witnesses& witnesses = *levels.witnesses;
  return lit_share(levels, [level8 = witnesses.level8(frame), low8 = witnesses.low8(), high8 = witnesses.high8()](
                               int w) { return high8[w] - level8[w] < kDarkShareOfContrast * (high8[w] - low8[w]); });
}

// Whether the view holds only a part of this phase frame's period; some frame of it must be lit.
bool sees_part_of_period(const ProbeLevels& levels, int frame) {
  const int channel = levels.plan->frames[static_cast<std::size_t>(frame)].accumulate.channel;
  if (channel == kNone) return false;  // a pattern shown again
  bool lit = false;
  for (int f = 0; f < levels.frames() && !lit; ++f) {
    lit = levels.plan->frames[static_cast<std::size_t>(f)].accumulate.channel == channel &&
          dark_share(levels, f) < kNearlyAll;
  }
  return lit && periods_in_view(levels, channel) < kPartOfPeriod;
}

const char* name(const ProbeLevels& levels, int frame) { return levels.spec(frame).file.c_str(); }

int find_frame(const ProbeLevels& levels, FrameKind kind) {
  for (int f = 0; f < levels.frames(); ++f) {
    if (levels.spec(f).kind == kind && levels.of_exposure(f)) return f;
  }
  return kNone;
}

int find_twin(const ProbeLevels& levels, int frame) {
  const FrameSpec& spec = levels.spec(frame);
  for (int f = 0; f < levels.frames(); ++f) {
    const FrameSpec& other = levels.spec(f);
    if (other.kind == FrameKind::kGray && other.axis == spec.axis && other.cell_px == spec.cell_px &&
        other.bit == spec.bit && other.inverted != spec.inverted && levels.of_exposure(f)) {
      return f;
    }
  }
  return kNone;
}

Result<void> check_references(const ProbeLevels& levels) {
  const int white = find_frame(levels, FrameKind::kWhite);
  const int black = find_frame(levels, FrameKind::kBlack);
  if (white == kNone || black == kNone) return {};
  if (dark_share(levels, white) > kNearlyAll && bright_share(levels, black) > 0.5F) {
    return failure(ResultCode::kSequenceOrderWrong, "%s is declared white and %s black, but they look exchanged",
                   name(levels, white), name(levels, black));
  }
  return {};
}

// Frames that cannot be dark all over: whole fringes, white, and one of a Gray frame and its twin.
Result<void> check_black(const ProbeLevels& levels) {
  for (int f = 0; f < levels.frames(); ++f) {
    const FrameKind kind = levels.spec(f).kind;
    if (kind == FrameKind::kBlack || !levels.of_exposure(f) || dark_share(levels, f) < kNearlyAll) continue;
    if (kind == FrameKind::kPhase && sees_part_of_period(levels, f)) continue;
    const int twin = kind == FrameKind::kGray ? find_twin(levels, f) : kNone;
    if (kind == FrameKind::kGray && (twin == kNone || dark_share(levels, twin) < kNearlyAll)) continue;
    return failure(ResultCode::kFrameBlack, "%s is black where its pattern should light the scene", name(levels, f));
  }
  return {};
}

// The share of (contrast / 2)^2 by which two patterns differ on average; 0 where they may look alike.
double expected_difference(const ProbeLevels& levels, int a, int b) {
  const FrameSpec& first = levels.spec(a);
  const FrameSpec& second = levels.spec(b);
  const bool phase_a = first.kind == FrameKind::kPhase;
  const bool phase_b = second.kind == FrameKind::kPhase;
  if (phase_a && sees_part_of_period(levels, a)) return 0.0;
  if (phase_b && sees_part_of_period(levels, b)) return 0.0;
  if (phase_a && phase_b && first.axis == second.axis && first.period_px == second.period_px) {
    const double shift =
        second.offset_rad - first.offset_rad +
        2.0 * kPi * (second.step / static_cast<double>(second.steps) - first.step / static_cast<double>(first.steps));
    return 1.0 - std::cos(shift);
  }
  if (phase_a || phase_b) return 0.5;
  if (first.kind == FrameKind::kGray && second.kind == FrameKind::kGray) {
    if (find_twin(levels, a) == b) return 4.0;
    // Two bits never change at the same places; but a view of few stripes may show neither changing.
    const float bright = bright_share(levels, b);
    return bright > 0.1F && bright < 0.9F ? 1.0 : 0.0;
  }
  const bool references = first.kind != FrameKind::kGray && second.kind != FrameKind::kGray;
  return references && first.kind != second.kind ? 4.0 : 0.0;
}

// Sums over the witnesses, of squared levels.
struct Likeness {
  double difference = 0.0, noise = 0.0, contrast = 0.0;
};

Likeness compare(const Witnesses& witnesses, int a, int b) {
  const float* before8 = witnesses.level8(a);
  const float* after8 = witnesses.level8(b);
  const float* low8 = witnesses.low8();
  const float* high8 = witnesses.high8();
  const auto squared = [](float level) { return level * level; };
  const auto sum = [&](auto value) { return sum_in_lanes(witnesses.count(), value); };
  return {sum([=](int w) { return squared(after8[w] - before8[w]); }),
          sum([=](int w) { return 2.0F * kCameraNoise.variance(after8[w]) + squared(kFlickerShare * after8[w]); }),
          sum([=](int w) { return squared(0.5F * (high8[w] - low8[w])); })};
}

Result<void> check_doubled(const ProbeLevels& levels) {
  for (int f = 1; f < levels.frames(); ++f) {
    if (!levels.of_exposure(f) || !levels.of_exposure(f - 1)) continue;
    const Likeness like = compare(*levels.witnesses, f - 1, f);
    if (like.difference > kSameEnergy * like.noise) continue;
    if (expected_difference(levels, f - 1, f) * like.contrast < kTellingEnergy * kSameEnergy * like.noise) continue;
    return failure(ResultCode::kFrameDuplicated,
                   "%s shows the same pattern as %s; the projector did not advance, or a file was doubled",
                   name(levels, f), name(levels, f - 1));
  }
  return {};
}

}  // namespace

float dark_share(const ProbeLevels& levels, int frame) {
  const Witnesses& witnesses = *levels.witnesses;
  return lit_share(levels, [level8 = witnesses.level8(frame), low8 = witnesses.low8(), high8 = witnesses.high8()](
                               int w) { return level8[w] - low8[w] < kDarkShareOfContrast * (high8[w] - low8[w]); });
}

Result<void> check_levels(const ProbeLevels& levels) {
  if (auto checked = check_references(levels); !checked) return checked;
  if (auto checked = check_black(levels); !checked) return checked;
  return check_doubled(levels);
}

}  // namespace beltpick::decode
