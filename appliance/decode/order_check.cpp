// Frames that stand where others belong.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "base/kernel.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "decode/fringe_sums.hpp"

namespace beltpick::decode {
namespace {

constexpr int kLeastWitnesses = 200;
constexpr float kStrongShare = 0.25F;  // of the contrast: how far from its threshold a bit is beyond doubt
constexpr int kReach = 6;              // probes between two words that are still of one surface

int binary_from_gray(unsigned gray) {
  unsigned binary = gray;
  for (unsigned shift = 1; shift < 16; shift *= 2) binary ^= binary >> shift;
  return static_cast<int>(binary);
}

const char* frame_of(const ProbeLevels& levels, const GrayBit& bit) {
  return levels.spec(bit.frame != kNone ? bit.frame : bit.twin_frame).file.c_str();
}

// The steps of one bit; none where so many change more that the image is too coarse for its stripes.
std::size_t collect_steps(const ProbeLevels& levels, std::span<WordStep> steps) {
  constexpr std::size_t kCoarse = 10;  // one in so many
  std::size_t count = 0;
  std::size_t jumps = 0;
  int last_at = -kReach - 1;
  std::uint16_t last = 0;
  for (int i = 0; i < levels.probes->count() && count < steps.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (levels.words.sure[at] != 0) {
      const std::uint16_t word = levels.words.word[at];
      const unsigned changed = last ^ word;
      const bool near = i - last_at <= kReach;
      if (near && (changed & (changed - 1)) != 0) ++jumps;
      if (near && changed != 0 && (changed & (changed - 1)) == 0) steps[count++] = {last, word};
      last = word;
      last_at = i;
    }
    if (!levels.probes->joined(i)) last_at = -kReach - 1;
  }
  return jumps * kCoarse > count ? 0 : count;
}

// Of the steps at which `bit` changes (any where kNone): how many, how many lead to the next cell of the projector, and
// how many begin or end beyond its last.
struct StepCount {
  int all = 0, legal = 0, beyond = 0;

  [[nodiscard]] double legal_share() const { return all == 0 ? 1.0 : legal / static_cast<double>(all); }
};

// `remap` is applied to both words first.
template <class Remap>
StepCount count_steps(std::span<const WordStep> steps, int cells, int bit, Remap remap) {
  StepCount count;
  for (const WordStep& step : steps) {
    const unsigned before = remap(step.before);
    const unsigned after = remap(step.after);
    if (bit != kNone && (before ^ after) != 1U << static_cast<unsigned>(bit)) continue;
    const int from = binary_from_gray(before);
    const int to = binary_from_gray(after);
    const bool inside = std::max(from, to) < cells;
    ++count.all;
    count.legal += inside && std::abs(from - to) == 1 ? 1 : 0;
    count.beyond += inside ? 0 : 1;
  }
  return count;
}

unsigned exchanged(unsigned word, unsigned a, unsigned b) {
  const unsigned differ = ((word >> a) ^ (word >> b)) & 1U;
  return word ^ (differ << a) ^ (differ << b);
}

// The Gray frame without twin that is dark all over; kNone without one.
int dark_frame(const ProbeLevels& levels, const GrayCode& code) {
  constexpr float kAllDark = 0.98F;
  for (const GrayBit& bit : code.bits) {
    if (bit.frame != kNone && bit.twin_frame != kNone) continue;
    const int frame = bit.frame != kNone ? bit.frame : bit.twin_frame;
    if (dark_share(levels, frame) >= kAllDark) return frame;
  }
  return kNone;
}

std::unexpected<Error> black_frame(const ProbeLevels& levels, int frame) {
  return failure(
      ResultCode::kFrameBlack,
      "%s is black, and so the code of the scene contradicts itself: it was not shown, or a frame before it is missing",
      levels.spec(frame).file.c_str());
}

// What would make the steps legal: two bits exchanged, or (a == b) one inverted.
struct Remedy {
  unsigned a = 0, b = 0;
  double legal_share = 0.0;
};

Remedy find_remedy(std::span<const WordStep> steps, const GrayCode& code) {
  const auto bits = static_cast<unsigned>(code.bits.size());
  Remedy best;
  for (unsigned a = 0; a < bits; ++a) {
    for (unsigned b = a; b < bits; ++b) {
      const auto mended = [&](unsigned word) { return a == b ? word ^ (1U << a) : exchanged(word, a, b); };
      const double share = count_steps(steps, code.cells, kNone, mended).legal_share();
      if (share > best.legal_share) best = {a, b, share};
    }
  }
  return best;
}

std::unexpected<Error> explain(const ProbeLevels& levels, Axis axis, const GrayCode& code,
                               std::span<const WordStep> steps) {
  constexpr double kExplained = 0.9;
  if (const int dark = dark_frame(levels, code); dark != kNone) return black_frame(levels, dark);
  const char* along = axis == Axis::kColumn ? "column" : "row";
  const Remedy remedy = find_remedy(steps, code);
  if (remedy.legal_share >= kExplained && remedy.a == remedy.b) {
    return failure(ResultCode::kSequenceOrderWrong, "the Gray frame %s (%s axis) looks inverted",
                   frame_of(levels, code.bits[remedy.a]), along);
  }
  if (remedy.legal_share >= kExplained) {
    return failure(ResultCode::kSequenceOrderWrong, "the Gray frames %s and %s (%s axis) look exchanged",
                   frame_of(levels, code.bits[remedy.b]), frame_of(levels, code.bits[remedy.a]), along);
  }
  return failure(ResultCode::kSequenceOrderWrong,
                 "the Gray frames of the %s axis do not fit their declared order: only %.0f %% of the steps between "
                 "neighbours lead to the next cell; check the frame list, and whether a frame is missing or doubled",
                 along,
                 100.0 * count_steps(steps, code.cells, kNone, [](unsigned word) { return word; }).legal_share());
}

// One bit of the words, of its upright frame, its inverted one or both; null: missing.
BELTPICK_KERNEL
void read_bit(const std::uint16_t* __restrict upright, const std::uint16_t* __restrict inverted, float to_level8,
              const float* __restrict low8, const float* __restrict high8, int count, unsigned bit,
              std::uint16_t* __restrict word, std::uint8_t* __restrict sure) {
  const bool twins = upright != nullptr && inverted != nullptr;
  const std::uint16_t* __restrict one = upright != nullptr ? upright : inverted;
  const std::uint16_t* __restrict other = inverted != nullptr ? inverted : upright;
  const float sign = upright != nullptr ? 1.0F : -1.0F;
  for (int i = 0; i < count; ++i) {
    const float middle = twins ? 0.5F * to_level8 * static_cast<float>(one[i] + other[i]) : 0.5F * (high8[i] + low8[i]);
    const float margin = sign * (to_level8 * static_cast<float>(one[i]) - middle);
    const bool doubtful = std::fabs(margin) < kStrongShare * (high8[i] - low8[i]);
    word[i] = static_cast<std::uint16_t>(word[i] | ((margin > 0.0F ? 1U : 0U) << bit));
    sure[i] = doubtful ? std::uint8_t{0} : sure[i];
  }
}

}  // namespace

void read_words(const ProbeLevels& levels, const GrayCode& code) {
  const int count = levels.probes->count();
  std::fill_n(levels.words.word.begin(), count, std::uint16_t{0});
  std::copy_n(levels.lit.begin(), count, levels.words.sure.begin());
  const auto frame = [&](int f) { return f == kNone ? nullptr : levels.probes->levels(f).data(); };
  for (std::size_t b = 0; b < code.bits.size(); ++b) {
    read_bit(frame(code.bits[b].frame), frame(code.bits[b].twin_frame), levels.to_level8, levels.low8.data(),
             levels.high8.data(), count, static_cast<unsigned>(b), levels.words.word.data(), levels.words.sure.data());
  }
}

Result<void> check_gray(const ProbeLevels& levels, Axis axis, const GrayCode& code, std::span<WordStep> steps) {
  constexpr int kLeastSteps = 40;
  constexpr double kLeastLegal = 0.7;
  constexpr double kMostBeyond = 0.1;  // the highest bits exchanged leave most steps legal, but lead too far
  constexpr int kLeastBitSteps = 8;
  constexpr double kLeastBitLegal = 0.3;
  const auto same = [](unsigned word) { return word; };
  const std::span<const WordStep> found = steps.first(collect_steps(levels, steps));
  const StepCount all = count_steps(found, code.cells, kNone, same);
  if (all.all >= kLeastSteps && (all.legal_share() < kLeastLegal || all.beyond > kMostBeyond * all.all)) {
    return explain(levels, axis, code, found);
  }
  for (int bit = 0; bit < static_cast<int>(code.bits.size()); ++bit) {
    const StepCount count = count_steps(found, code.cells, bit, same);
    if (count.all >= kLeastBitSteps && count.legal_share() < kLeastBitLegal) {
      return explain(levels, axis, code, found);
    }
  }
  return {};
}

Result<void> check_agreement(const ProbeLevels& levels, Axis axis, const GrayCode& code, int channel) {
  constexpr float kLeastAmplitude = 0.1F;  // of the contrast
  constexpr double kMostContrary = 0.08;   // sound captures have below one percent
  const PhaseChannel& fringes = levels.plan->channels[static_cast<std::size_t>(channel)];
  const auto period_px = static_cast<float>(fringes.period_px);
  const auto cell_px = static_cast<float>(code.cell_px);
  if (cell_px > 0.75F * period_px || fringes.exposure_us != levels.exposure_us) return {};
  int witnesses = 0;
  int contrary = 0;
  double offsets_px = 0.0;
  for (int first = 0; first < levels.witnesses->count(); first += Witnesses::kBlock) {
    const FringeBlock fringe = fringe_block(levels, channel, first);
    for (int k = 0; k < fringe.count; ++k) {
      const auto n = static_cast<std::size_t>(k);
      const auto at = static_cast<std::size_t>(levels.witnesses->probe(first + k));
      const float least = kLeastAmplitude * (levels.high8[at] - levels.low8[at]);
      const float squared = fringe.cosine[n] * fringe.cosine[n] + fringe.sine[n] * fringe.sine[n];
      if (levels.words.sure[at] == 0 || squared <= least * least) continue;
      const float turn = std::atan2(fringe.sine[n], fringe.cosine[n]) / static_cast<float>(2.0 * kPi);
      const float centre_px = (static_cast<float>(binary_from_gray(levels.words.word[at])) + 0.5F) * cell_px - 0.5F;
      const float orders = (centre_px - turn * period_px) / period_px;
      const float offset_px = (std::floor(orders + 0.5F) - orders) * period_px;
      ++witnesses;
      contrary += std::fabs(offset_px) > 0.25F * (cell_px + period_px) ? 1 : 0;
      offsets_px += static_cast<double>(offset_px);
    }
  }
  if (witnesses < kLeastWitnesses) return {};
  const char* along = axis == Axis::kColumn ? "column" : "row";
  if (contrary > kMostContrary * witnesses) {
    if (const int dark = dark_frame(levels, code); dark != kNone) return black_frame(levels, dark);
    return failure(ResultCode::kSequenceOrderWrong,
                   "Gray code and phase of the %s axis contradict each other at %d of %d places: frames are out of "
                   "order, missing or doubled",
                   along, contrary, witnesses);
  }
  const double shift_px = offsets_px / witnesses;
  if (std::fabs(shift_px) > std::max(0.125 * cell_px, 1.0)) {
    return failure(ResultCode::kSequenceOrderWrong,
                   "the phase of the %s axis stands %.1f px off its Gray code: check the order and offset_rad of the "
                   "phase frames",
                   along, shift_px);
  }
  return {};
}

}  // namespace beltpick::decode
