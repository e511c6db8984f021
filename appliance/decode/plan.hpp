// FoldPlan: what to do with each frame of a sequence as it arrives, and what the decoder finishes at the end. Made once
// from a Sequence, before any capture; says why where a sequence does not determine the projector coordinate.
//
// A plane is a picture's worth of per-pixel state; the plan numbers planes and the decoder places them in its memory.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/capture.hpp"
#include "contract/exposures.hpp"

namespace beltpick::decode {

inline constexpr int kNone = -1;
inline constexpr std::size_t kMaxTogether = 4;  // phase frames that are added to their sums in one go
// A sequence that needs less than this for each pixel of 8 bits may spend the rest on keeping phase frames until others
// can be added together with them; so one axis with white, black, 12 phase steps and 8 Gray bits takes 13.
inline constexpr int kStateBytes = 16;

// What a pixel takes, for cameras of 8 and of 16 bits.
enum class PlaneKind : std::uint8_t {
  kSum,    // fringe component, later phase or amplitude: int16 or float
  kMean,   // sum of phase frames: uint16 or float
  kRaw,    // a frame's pixels: uint8 or uint16
  kBits,   // a Gray bit and whether it is weak: two bits; rows as bit_kernels.hpp lays them out
  kFlags,  // one bit an exposure: saturated: uint8
};
int plane_bits(PlaneKind kind, int pixel_bytes);

// The fringes of one period: cosine = b cos(phi), sine = b sin(phi), phi = 2 pi x / period_px, by least squares over
// the frames' phase shifts (which also serves unequal shifts).
struct PhaseChannel {
  double period_px = 0.0;
  int frames = 0;
  // Once the last frame has come: phase and amplitude, see phase_kernels.hpp.
  int cosine_plane = kNone, sine_plane = kNone;
  int mean_plane = kNone;       // only where a threshold or the texture needs it
  double counts_per_level = 1;  // of the int16 sums
  double noise_gain = 0.0;      // sigma of cosine and sine over sigma of one grey level; sqrt(2 / N) for equal shifts
  double exposure_us = 0.0;
  int last_frame = 0;
  int equal_steps = 0;               // shifts of a full turn in equal steps; 0 where they are otherwise
  double offset_rad = 0.0;           // of one of them
  std::uint8_t saturation_bits = 0;  // of the flags plane: its own
};

// What tells a pixel's brightest and darkest level: the white and black frames, or the running extremes of a Gray code
// with twins, or mean and amplitude of the fringes. White may be there alone.
struct Reference {
  int white_plane = kNone, black_plane = kNone;
  float scale = 1.0F;  // this exposure over that of the white frame
  int mean_channel = kNone;
};

enum class ThresholdKind : std::uint8_t { kTwin, kMidpoint, kMean };

// The level that parts bright from dark; `scale` is the ratio of exposures where they differ.
struct Threshold {
  ThresholdKind kind = ThresholdKind::kTwin;
  int plane = kNone;        // the twin, white, or the mean
  int black_plane = kNone;  // kMidpoint
  float scale = 1.0F;
  // The threshold itself and how far levels reach from it, where both are known before the end; not for twins.
  int level_plane = kNone, reach_plane = kNone;

  bool operator==(const Threshold&) const = default;
};

struct GrayBit {
  int frame = kNone, twin_frame = kNone;  // upright and inverted; one of them may be missing
  int plane = kNone;                      // of the resolved bit
  int raw_plane = kNone;                  // instead: kept until the end because its threshold comes later
  Threshold threshold;
};

// One Gray code, bit 0 of width cell_px. Cell c covers [c cell_px - 0.5, (c + 1) cell_px - 0.5).
struct GrayCode {
  double cell_px = 0.0;
  int cells = 0;
  std::vector<GrayBit> bits;   // least significant first
  float weak_fraction = 0.0F;  // of half the contrast: a bit nearer its threshold counts as weak
};

enum class Method : std::uint8_t { kNotCoded, kGrayOnly, kGrayPhase, kSearch };

// How one axis is decoded from one exposure. Channels and codes by index into the plan; finest period first.
struct AxisPlan {
  Method method = Method::kNotCoded;
  double extent_px = 0.0;
  std::vector<int> channels;
  int gray = kNone;
};

// One exposure of a capture; all but HDR captures have one.
struct ExposurePlan {
  double exposure_us = 0.0;
  std::array<AxisPlan, 2> axes;  // by Axis
  Reference reference;
  std::uint8_t saturation_bit = 1;
};

struct Accumulate {
  int channel = kNone;
  float cosine_weight = 0.0F, sine_weight = 0.0F;           // a grey level's share of the components
  std::int16_t cosine_weight_q15 = 0, sine_weight_q15 = 0;  // the same for (level << 7) * weight >> 15 in counts
  // Frames of this channel that are added when this one arrives: it and `together` - 1 earlier ones, which were kept
  // until then; 0 where this one is kept itself.
  int together = 0;
  std::array<int, kMaxTogether - 1> earlier{};
  bool first = false;  // sets the sums instead of adding to them
  bool last = false;   // the sums are whole: phase and amplitude take their place
  bool first_flags = false;
  std::uint8_t saturation_bit = 0;
};

struct ResolveBit {
  int gray = kNone, bit = kNone;
  bool inverted = false;           // this frame is the inverted one
  bool prepare_threshold = false;  // first fills the threshold's planes
};

// What one frame does. kNone: does not.
struct FrameWork {
  int keep_plane = kNone;
  Accumulate accumulate;
  ResolveBit resolve;
  Reference extremes;  // running extremes of white and black to update
  bool first_extremes = false;
};

// The pattern shown again at the end: `plane` holds it from frame `first` on, and after `last` how much they differ.
struct RepeatedPattern {
  int first = kNone, last = kNone;
  int plane = kNone;
};

struct FoldPlan {
  Sequence sequence;
  std::vector<PlaneKind> planes;
  std::vector<PhaseChannel> channels;
  std::vector<GrayCode> grays;
  std::vector<ExposurePlan> exposures;
  std::vector<FrameWork> frames;  // one for each frame of the sequence
  int flags_plane = kNone;
  RepeatedPattern repeated;
  bool correct_ripple = true;  // of the projector's gamma, where it is found in the images

  [[nodiscard]] bool codes(Axis axis) const {
    return exposures.front().axes[static_cast<std::size_t>(axis)].method != Method::kNotCoded;
  }
  // State of the decoder for each pixel, outputs not included. `pixel_bytes`: 1 or 2, the camera's.
  [[nodiscard]] int state_bytes(int pixel_bytes) const;
};

// The noise of the coordinates that `plan` gives along `axis`; all zero where it codes none.
CodeNoise code_noise(const FoldPlan& plan, Axis axis);

// Plans the decoding of `sequence`. Error: kSequenceUndecodable (what lacks, and where), kLimitExceeded (exposures).
Result<FoldPlan> make_fold_plan(const Sequence& sequence);

}  // namespace beltpick::decode
