// Whether the scene stood still: the texture that the first frames show against that of later ones, along the probes'
// lines. A later line is the first one moved by s: late = gain (early - s early'), to first order; least squares gives
// s.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"
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
constexpr float kBrightShare = 0.55F;  // of the contrast: under a bright stripe, though the texture moved
constexpr int kBorder = 2;             // probes that bright ones must keep off their stripe's border
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
  double probes = 0.0;
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

// A frame to be compared with the early ones.
struct Late {
  std::span<const float> level8, texture8;  // by probe
  std::span<const std::uint8_t> well_lit;   // 1 well within a bright stripe
};

// The probes along rows of the image, or along its columns.
struct LineSet {
  int first = 0, end = 0, length = 0;
};
LineSet lines(const FrameProbes& probes, bool along_rows) {
  return along_rows ? LineSet{0, probes.in_row_lines(), probes.line_length(0)}
                    : LineSet{probes.in_row_lines(), probes.count(), probes.line_length(probes.in_row_lines())};
}

BELTPICK_KERNEL
void find_bright(const float* __restrict level8, const float* __restrict low8, const float* __restrict high8,
                 const std::uint8_t* __restrict lit, int count, std::uint8_t* __restrict bright) {
  for (int i = 0; i < count; ++i) {
    const bool above = (level8[i] > low8[i] + kBrightShare * (high8[i] - low8[i])) & (high8[i] < 254.0F);
    bright[i] = above ? lit[i] : std::uint8_t{0};
  }
}

// 1 where all of `reach` probes before and after are bright as well, along a line of `length` probes.
BELTPICK_KERNEL
void keep_inner(const std::uint8_t* __restrict bright, int length, int reach, std::uint8_t* __restrict inner) {
  std::fill_n(inner, length, std::uint8_t{0});
  const int count = length - 2 * reach;
  for (int i = 0; i < count; ++i) inner[reach + i] = bright[i];
  for (int k = 1; k <= 2 * reach; ++k) {
    for (int i = 0; i < count; ++i) inner[reach + i] = static_cast<std::uint8_t>(inner[reach + i] & bright[i + k]);
  }
}

// The probes of a frame that lie well within a bright stripe.
void find_well_lit(const ProbeLevels& levels, const MotionScratch& scratch) {
  const FrameProbes& probes = *levels.probes;
  find_bright(scratch.late8.data(), levels.low8.data(), levels.high8.data(), levels.lit.data(), probes.count(),
              scratch.bright.data());
  for (int first = 0; first < probes.count(); first += probes.line_length(first)) {
    keep_inner(&scratch.bright[static_cast<std::size_t>(first)], probes.line_length(first), kBorder + kReach,
               &scratch.well_lit[static_cast<std::size_t>(first)]);
  }
}

// What a level has over the mean of its neighbours, for all probes of a line at least kReach from its ends.
BELTPICK_KERNEL
void local_contrast(const float* __restrict level8, int length, float* __restrict out) {
  constexpr float kShare = 1.0F / (2 * kReach + 1);
  for (int i = kReach; i < length - kReach; ++i) {
    float sum = level8[i];
#pragma GCC unroll 8  // before vectorisation, which takes no inner loops
    for (int k = 1; k <= kReach; ++k) sum += level8[i - k] + level8[i + k];
    out[i] = level8[i] - sum * kShare;
  }
}

// How fast the level grows along the line, over the mean of its neighbours. `work`: room for the line.
void local_slope(const float* level8, int length, float* work, float* out) {
  work[0] = work[length - 1] = 0.0F;
  for (int i = 1; i + 1 < length; ++i) work[i] = 0.5F * (level8[i + 1] - level8[i - 1]);
  local_contrast(work, length, out);
}

BELTPICK_KERNEL
void take_levels(const std::uint16_t* __restrict levels, int count, float to_level8, float* __restrict level8) {
  for (int i = 0; i < count; ++i) level8[i] = to_level8 * static_cast<float>(levels[i]);
}

// Sixteen probes of a line at a time.
struct LaneSums {
  static constexpr int kLanes = 16;
  using Lanes = std::array<float, kLanes>;
  Lanes ee{}, eg{}, gg{}, le{}, lg{}, ll{}, early{}, late{}, noise{}, probes{};
};

// What probe i adds to a lane, with the early one `whole_px` before it; `counts` is 1 or 0.
[[gnu::always_inline]] inline void add_probe(const Early& early, const Late& late, int i, int whole_px, float counts,
                                             std::size_t lane, LaneSums& s) {
  const float early8 = early.level8.data()[i - whole_px];
  const float before = early.texture8.data()[i - whole_px];
  const float steep = early.slope8.data()[i - whole_px];
  const float late8 = late.level8.data()[i];
  const float after = late.texture8.data()[i];
  const float weight = counts / kCameraNoise.variance(late8);
  s.ee[lane] += before * before * weight;
  s.eg[lane] += before * steep * weight;
  s.gg[lane] += steep * steep * weight;
  s.le[lane] += after * before * weight;
  s.lg[lane] += after * steep * weight;
  s.ll[lane] += after * after * weight;
  s.early[lane] += counts * early8;
  s.late[lane] += counts * late8;
  s.noise[lane] += early.noise_share * kCameraNoise.variance(early8) * weight;
  s.probes[lane] += counts;
}

// The probes [begin, end) of a line, with the early ones `whole_px` before them.
BELTPICK_KERNEL
void add_line(const Early& early_given, const Late& late_given, int begin, int end, int whole_px, LaneSums& sums) {
  const Early early = early_given;
  const Late late = late_given;
  LaneSums s = sums;
  int first = begin;
  for (; first + LaneSums::kLanes <= end; first += LaneSums::kLanes) {
    LaneSums::Lanes counts;
    for (std::size_t lane = 0; lane < LaneSums::kLanes; ++lane) {
      counts[lane] = static_cast<float>(late.well_lit.data()[first + static_cast<int>(lane)]);
    }
    for (std::size_t lane = 0; lane < LaneSums::kLanes; ++lane) {
      add_probe(early, late, first + static_cast<int>(lane), whole_px, counts[lane], lane, s);
    }
  }
  for (std::size_t lane = 0; first < end; ++first, ++lane) {
    add_probe(early, late, first, whole_px, static_cast<float>(late.well_lit.data()[first]), lane, s);
  }
  sums = s;
}

// Least squares about a shift by whole pixels.
ShiftSums sum_about(const FrameProbes& probes, const Early& early, const Late& late, bool along_rows, int whole_px) {
  const LineSet set = lines(probes, along_rows);
  const int margin = std::abs(whole_px) + kReach + 1;
  ShiftSums sums;
  for (int first = set.first; first < set.end; first += set.length) {
    LaneSums lanes;
    add_line(early, late, first + margin, first + set.length - margin, whole_px, lanes);
    const auto add = [](double& sum, const LaneSums::Lanes& values) {
      for (const float value : values) sum += static_cast<double>(value);
    };
    add(sums.ee, lanes.ee);
    add(sums.eg, lanes.eg);
    add(sums.gg, lanes.gg);
    add(sums.le, lanes.le);
    add(sums.lg, lanes.lg);
    add(sums.ll, lanes.ll);
    add(sums.early, lanes.early);
    add(sums.late, lanes.late);
    add(sums.noise, lanes.noise);
    add(sums.probes, lanes.probes);
  }
  return sums;
}

// The shift by whole pixels at which the textures are most alike; 0 unless another one is it clearly.
int find_whole_shift(const FrameProbes& probes, const Early& early, const Late& late, bool along_rows) {
  const auto alike_at = [&](int whole_px) {
    const ShiftSums sums = sum_about(probes, early, late, along_rows, whole_px);
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
double find_shift(const FrameProbes& probes, const Early& early, const Late& late, bool along_rows) {
  const ShiftSums here = sum_about(probes, early, late, along_rows, 0);
  if (here.probes < kLeastProbes || here.ee < kTextureOverNoise * here.noise || stands(here)) return 0.0;
  Shift shift = solve(here, 0);
  if (!shift.certain || std::abs(shift.px) > kBeyondLinear_px) {
    const int whole_px = find_whole_shift(probes, early, late, along_rows);
    if (whole_px != 0) shift = solve(sum_about(probes, early, late, along_rows, whole_px), whole_px);
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
  const FrameProbes& probes = *levels.probes;
  for (int first = 0; first < probes.count(); first += probes.line_length(first)) {
    const auto at = static_cast<std::size_t>(first);
    local_contrast(&early.level8[at], probes.line_length(first), &early.texture8[at]);
    local_slope(&early.level8[at], probes.line_length(first), &scratch.late8[at], &early.slope8[at]);
  }
  return early;
}

Late gather_late(const ProbeLevels& levels, int frame, const MotionScratch& scratch) {
  const FrameProbes& probes = *levels.probes;
  take_levels(probes.levels(frame).data(), probes.count(), levels.to_level8, scratch.late8.data());
  for (int first = 0; first < probes.count(); first += probes.line_length(first)) {
    const auto at = static_cast<std::size_t>(first);
    local_contrast(&scratch.late8[at], probes.line_length(first), &scratch.late_texture8[at]);
  }
  find_well_lit(levels, scratch);
  return {scratch.late8, scratch.late_texture8, scratch.well_lit};
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
    const Late late = gather_late(levels, f, scratch);
    const auto shift_px = [&](bool along_rows) { return find_shift(*levels.probes, early, late, along_rows); };
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
