// Whether the scene stood still: the texture that the first frames show against that of later ones, along the probes'
// lines. A later line is the first one moved by s: late = gain (early - s early'), to first order; least squares gives
// s.
#include <algorithm>
#include <cmath>

#include "base/camera_noise.hpp"
#include "contract/result_codes.hpp"
#include "decode/frame_check.hpp"

namespace beltpick::decode {
namespace {

constexpr double kSignificant = 6.0;  // standard deviations
// A belt that sways by a quarter of a millimetre after its stop shows a twentieth of a pixel.
constexpr double kTolerated_px = 0.35;
constexpr double kFar_px = 4.0;
constexpr double kBeyondLinear_px = 0.25;  // a larger shift is looked for step by step first
constexpr int kSearched_px = 16;
constexpr int kLeastProbes = 300;
constexpr std::size_t kSearchProbes = 500;  // that look for a shift by whole pixels
constexpr float kBrightShare = 0.55F;       // of the contrast: under a bright stripe, though the texture moved
constexpr int kBorder = 2;                  // probes that bright ones must keep off their stripe's border
constexpr int kReach = 5;  // probes either side whose mean is taken off: what varies slower is light, not texture
constexpr double kTextureOverNoise = 1.5;
constexpr double kOfOneTexture = 0.5;  // of the gain that the levels tell: less of the early texture is not it

// The texture under even light that the first frames show, by probe.
struct Early {
  std::span<float> level8;
  std::span<float> texture8;  // what a level has over the mean of its neighbours
  std::span<float> slope8;    // how fast the level grows along the line, over the mean of its neighbours
  int last_frame = kNone;     // of those that show it; kNone where there is none
  float noise_share = 1.0F;   // of the variance of one frame
};

// Sums of the least squares for gain and gain * shift, of levels less their neighbours' mean.
struct ShiftSums {
  double ee = 0.0, eg = 0.0, gg = 0.0, le = 0.0, lg = 0.0, ll = 0.0;
  double early = 0.0, late = 0.0, noise = 0.0;
  int probes = 0;
};

struct Shift {
  double px = 0.0;
  bool certain = false;
};

// About a shift by whole pixels.
Shift solve(const ShiftSums& sums, int whole_px) {
  const double determinant = sums.ee * sums.gg - sums.eg * sums.eg;
  if (determinant <= 1e-9 * sums.ee * sums.gg) return {};
  const double gain = (sums.le * sums.gg - sums.lg * sums.eg) / determinant;
  const double px = whole_px - (sums.lg * sums.ee - sums.le * sums.eg) / determinant / gain;
  const double sigma_px = std::sqrt(sums.ee / determinant) / std::abs(gain);
  const bool one_texture = gain > kOfOneTexture * sums.late / sums.early;
  return {px, one_texture && std::abs(px) > kSignificant * sigma_px};
}

// Whether noise alone explains how late levels differ from early ones where they stand, but for a gain.
bool stands(const ShiftSums& sums) {
  const double gain = sums.le / sums.ee;
  const double unlike = sums.ll - gain * sums.le;
  const double expected = sums.probes + gain * gain * sums.noise;
  return unlike < expected + kSignificant * std::sqrt(2.0 * expected);
}

bool bright(const ProbeLevels& levels, int frame, int i) {
  const auto at = static_cast<std::size_t>(i);
  const float contrast = levels.high8[at] - levels.low8[at];
  return levels.lit[at] != 0 && levels.level8(frame, i) > levels.low8[at] + kBrightShare * contrast;
}

// A frame to be compared with the early ones: what its well lit probes show.
struct Late {
  int frame = kNone;
  std::span<const float> texture8;     // by probe
  std::span<const std::uint32_t> lit;  // probes that lie well within a bright stripe, along one axis of the image
};

// The probes of `frame` that lie well within a bright stripe, along rows or columns of the image.
std::span<const std::uint32_t> find_lit(const ProbeLevels& levels, int frame, bool along_rows,
                                        std::span<std::uint32_t> out) {
  constexpr int kHalf = kBorder + kReach;
  const FrameProbes& probes = *levels.probes;
  const int end = along_rows ? probes.in_row_lines() : probes.count();
  std::size_t count = 0;
  for (int first = along_rows ? 0 : probes.in_row_lines(); first < end; first += probes.line_length(first)) {
    const int line_end = first + probes.line_length(first);
    int run = 0;  // bright probes up to here
    for (int i = first; i < line_end; ++i) {
      run = bright(levels, frame, i) && levels.high8[static_cast<std::size_t>(i)] < 254.0F ? run + 1 : 0;
      if (run > 2 * kHalf) out[count++] = static_cast<std::uint32_t>(i - kHalf);
    }
  }
  return out.first(count);
}

// What value(i) has over the mean of its neighbours, for all probes at least `margin` from the ends of their line.
template <class Value>
void local_contrast(const FrameProbes& probes, int margin, Value value, std::span<float> out) {
  constexpr float kShare = 1.0F / (2 * kReach + 1);
  for (int first = 0; first < probes.count(); first += probes.line_length(first)) {
    const int begin = first + margin;
    const int end = first + probes.line_length(first) - margin;
    float sum = 0.0F;
    for (int k = begin - kReach; k < begin + kReach && begin < end; ++k) sum += value(k);
    for (int i = begin; i < end; ++i) {
      sum += value(i + kReach);
      out[static_cast<std::size_t>(i)] = value(i) - sum * kShare;
      sum -= value(i - kReach);
    }
  }
}

// Least squares about a shift by whole pixels, over every `every`th probe.
ShiftSums sum_about(const ProbeLevels& levels, const Early& early, const Late& late, int whole_px, std::size_t every) {
  ShiftSums sums;
  const int margin = std::abs(whole_px) + kReach + 1;
  for (std::size_t n = 0; n < late.lit.size(); n += every) {
    const auto i = static_cast<int>(late.lit[n]);
    if (levels.probes->to_line_end(i) < margin) continue;
    const auto at = static_cast<std::size_t>(i - whole_px);
    const auto before = static_cast<double>(early.texture8[at]);
    const auto steep = static_cast<double>(early.slope8[at]);
    const auto after = static_cast<double>(late.texture8[late.lit[n]]);
    const float late_level8 = levels.level8(late.frame, i);
    const double weight = 1.0 / static_cast<double>(kCameraNoise.variance(late_level8));
    sums.ee += before * before * weight;
    sums.eg += before * steep * weight;
    sums.gg += steep * steep * weight;
    sums.le += after * before * weight;
    sums.lg += after * steep * weight;
    sums.ll += after * after * weight;
    sums.early += static_cast<double>(early.level8[at]);
    sums.late += static_cast<double>(late_level8);
    sums.noise += static_cast<double>(early.noise_share * kCameraNoise.variance(early.level8[at])) * weight;
    ++sums.probes;
  }
  return sums;
}

// The shift by whole pixels at which the textures are most alike; 0 unless another one is it clearly.
int find_whole_shift(const ProbeLevels& levels, const Early& early, const Late& late) {
  const std::size_t every = std::max<std::size_t>(1, late.lit.size() / kSearchProbes);
  const auto alike_at = [&](int whole_px) {
    const ShiftSums sums = sum_about(levels, early, late, whole_px, every);
    return sums.le / std::sqrt(std::max(sums.ee, 1e-9));
  };
  const double alike_here = alike_at(0);
  double most_alike = alike_here;
  int best_px = 0;
  for (int whole_px = -kSearched_px; whole_px <= kSearched_px; ++whole_px) {
    const double alike = alike_at(whole_px);
    if (alike <= most_alike) continue;
    most_alike = alike;
    best_px = whole_px;
  }
  // Of smooth shading all shifts look about alike; noise then chooses.
  return most_alike - alike_here > kSignificant ? best_px : 0;
}

// The shift of a frame against the early texture; 0 where none is certain.
double find_shift(const ProbeLevels& levels, const Early& early, const Late& late) {
  const ShiftSums here = sum_about(levels, early, late, 0, 1);
  if (here.probes < kLeastProbes || here.ee < kTextureOverNoise * here.noise || stands(here)) return 0.0;
  Shift shift = solve(here, 0);
  if (!shift.certain || std::abs(shift.px) > kBeyondLinear_px) {
    const int whole_px = find_whole_shift(levels, early, late);
    if (whole_px != 0) shift = solve(sum_about(levels, early, late, whole_px, 1), whole_px);
  }
  return shift.certain ? shift.px : 0.0;
}

// From the white frame, or the mean of the first period's phase frames.
Early gather_levels(const ProbeLevels& levels, const MotionScratch& scratch) {
  const std::span<float> early8 = scratch.early8;
  const auto count = static_cast<std::size_t>(levels.probes->count());
  int channel = kNone;
  for (int f = 0; f < levels.frames() && channel == kNone; ++f) {
    if (!levels.of_exposure(f)) continue;
    if (levels.spec(f).kind == FrameKind::kWhite) {
      for (std::size_t i = 0; i < count; ++i) early8[i] = levels.level8(f, static_cast<int>(i));
      return {early8, scratch.texture8, scratch.slope8, f, 1.0F};
    }
    channel = levels.plan->frames[static_cast<std::size_t>(f)].accumulate.channel;
  }
  if (channel == kNone) return {};
  const PhaseChannel& fringes = levels.plan->channels[static_cast<std::size_t>(channel)];
  Early early{early8, scratch.texture8, scratch.slope8, fringes.last_frame, 1.0F / static_cast<float>(fringes.frames)};
  std::fill_n(early8.begin(), count, 0.0F);
  for (int f = 0; f <= fringes.last_frame; ++f) {
    if (levels.plan->frames[static_cast<std::size_t>(f)].accumulate.channel != channel) continue;
    for (std::size_t i = 0; i < count; ++i) early8[i] += early.noise_share * levels.level8(f, static_cast<int>(i));
  }
  return early;
}

Early gather_early(const ProbeLevels& levels, const MotionScratch& scratch) {
  const Early early = gather_levels(levels, scratch);
  if (early.last_frame == kNone) return early;
  const auto level8 = [&](int k) { return early.level8[static_cast<std::size_t>(k)]; };
  local_contrast(*levels.probes, kReach, level8, early.texture8);
  local_contrast(
      *levels.probes, kReach + 1, [&](int k) { return 0.5F * (level8(k + 1) - level8(k - 1)); }, early.slope8);
  return early;
}

// Where a frame stands against the early ones.
struct Farthest {
  int frame = kNone;
  double x_px = 0.0, y_px = 0.0;

  [[nodiscard]] double px() const { return std::hypot(x_px, y_px); }
};

Error moved(const ProbeLevels& levels, const Farthest& at) {
  return failure(ResultCode::kBeltMovedDuringCapture,
                 "the scene moved during the capture: by %s it stands %.1f px along the rows and %.1f px along the "
                 "columns of the image from where the first frames saw it; capture only when the belt stands still",
                 levels.spec(at.frame).file.c_str(), at.x_px, at.y_px)
      .error();
}

}  // namespace

Result<void> check_motion(const ProbeLevels& levels, const MotionScratch& scratch) {
  const Early early = gather_early(levels, scratch);
  if (early.last_frame == kNone) return {};
  // One frame may be misled by what its bright stripes happen to show: the second farthest is believed.
  Farthest first, second;
  for (int f = early.last_frame + 1; f < levels.frames(); ++f) {
    const FrameKind kind = levels.spec(f).kind;
    if (!levels.of_exposure(f) || (kind != FrameKind::kGray && kind != FrameKind::kWhite)) continue;
    if (levels.spec(f).inverted) continue;  // beside its twin
    local_contrast(
        *levels.probes, kReach, [&](int k) { return levels.level8(f, k); }, scratch.late8);
    const auto shift_px = [&](bool along_rows) {
      return find_shift(levels, early, {f, scratch.late8, find_lit(levels, f, along_rows, scratch.lit)});
    };
    const Farthest here{f, shift_px(true), shift_px(false)};
    if (here.px() > first.px()) second = first;
    Farthest& beaten = here.px() > first.px() ? first : second;
    if (here.px() > beaten.px()) beaten = here;
  }
  if (second.px() < kTolerated_px) return {};
  const Error error = moved(levels, second);
  if (second.px() > kFar_px) return std::unexpected(error);
  levels.findings->add(error);
  return {};
}

}  // namespace beltpick::decode
