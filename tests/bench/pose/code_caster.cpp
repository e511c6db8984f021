#include "bench/pose/code_caster.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/units.hpp"
#include "bench/pose/need.hpp"
#include "decode/plan.hpp"
#include "virtual_cell/render/visibility.hpp"

namespace beltpick::bench {
namespace {

namespace vc = virtual_cell;

constexpr float kFullLevel = 255.0F;
constexpr float kEdgeStepMm = 1.5F;     // between neighbours, in depth
constexpr int kEdgeSide = 3;            // rays through an edge pixel, squared
constexpr float kContrast = 0.95F;      // of a fringe, after the projector's blur
constexpr float kSaturated = 0.995F;    // of full scale
constexpr float kMostNoisePx = 0.18F;   // a noisier coordinate is no measurement
constexpr float kPeriodErrors = 5e-5F;  // share of pixels off by a period, as measured on hard real captures
constexpr float kLightAround = 0.018F;  // scattered about the scene, beside the ambient light

std::size_t triangulator_bytes(int rows, int cols) {
  Arena measuring;
  const range::Triangulator triangulator(measuring, rows, cols);
  return measuring.used_bytes();
}

double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(2.0 * kPi * random.uniform());
}

float finest_period_px(const Sequence& sequence) {
  double finest = std::numeric_limits<double>::max();
  for (const FrameSpec& frame : sequence.frames) {
    if (frame.kind == FrameKind::kPhase) finest = std::min(finest, frame.period_px);
  }
  return static_cast<float>(finest);
}

bool differ(const vc::LightSample& a, const vc::LightSample& b) {
  return a.instance != b.instance || (a.direct > 0.0F) != (b.direct > 0.0F) ||
         std::abs(a.distance - b.distance) > kEdgeStepMm;
}

}  // namespace

CodeCaster::CodeCaster(const vc::Rig& rig, std::span<const vc::ScenePart> parts, const Calibration& calibration,
                       const Sequence& sequence)
    : rig_(rig),
      scene_(parts, rig.T_camera_belt),
      rays_(rig.camera),
      period_px_(finest_period_px(sequence)),
      rows_(rig.camera.height),
      cols_(rig.camera.width),
      block_(triangulator_bytes(rows_, cols_)),
      arena_(block_.data(), block_.bytes()),
      triangulator_(arena_, rows_, cols_) {
  noise_ = decode::code_noise(need(decode::make_fold_plan(sequence)), Axis::kColumn);
  need(triangulator_.load(calibration));
  const std::size_t size = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_);
  pixels_.resize(size), instance_.resize(size), column_px_.resize(size), modulation_.resize(size);
  texture_.resize(size), state_.resize(size);
}

RangeImage CodeCaster::cast(std::span<const vc::PartInstance> instances, std::uint64_t seed) {
  scene_.place(instances);
  const vc::Caster caster(rig_, scene_, options_, seed);
  trace(caster);
  mix_edges(caster);
  Random random(seed, 31);
  decode(gain(), random);
  put_glare(random);
  const CodeImage code{{column_px_.data(), rows_, cols_},
                       {},
                       {modulation_.data(), rows_, cols_},
                       {texture_.data(), rows_, cols_},
                       {state_.data(), rows_, cols_},
                       noise_,
                       {}};
  return need(triangulator_.measure(code));
}

RangeImage CodeCaster::cast_points(std::span<const vc::PartInstance> instances, std::uint64_t seed, double noise_mm) {
  scene_.place(instances);
  trace(vc::Caster(rig_, scene_, options_, seed));
  Random random(seed, 32);
  point_mm_.resize(pixels_.size());
  sigma_mm_.assign(pixels_.size(), static_cast<float>(noise_mm));
  for (int row = 0, i = 0; row < rows_; ++row) {
    for (int col = 0; col < cols_; ++col, ++i) {
      const vc::LightSample& sample = pixels_[static_cast<std::size_t>(i)].middle;
      const Vec3f ray = rays_.at(row, col);
      const auto off_mm = static_cast<float>(noise_mm * normal(random)) / ray.norm();
      point_mm_[static_cast<std::size_t>(i)] =
          sample.direct > 0.0F ? Vec3f((sample.distance + off_mm) * ray) : Vec3f::Zero();
    }
  }
  return {{point_mm_.data(), rows_, cols_}, {sigma_mm_.data(), rows_, cols_}, {}};
}

ImageView<const std::uint16_t> CodeCaster::instances() const { return {instance_.data(), rows_, cols_}; }

std::vector<double> CodeCaster::visible_fractions() const { return vc::visible_fractions(rig_, scene_); }

void CodeCaster::trace(const vc::Caster& caster) {
  for (int row = 0, i = 0; row < rows_; ++row) {
    for (int col = 0; col < cols_; ++col, ++i) {
      Pixel& pixel = pixels_[static_cast<std::size_t>(i)];
      pixel.middle = caster.trace(rays_.at(row, col), 1.0F);
      pixel.column_px = pixel.middle.column_px;
      pixel.amplitude = pixel.middle.direct;
      pixel.ambient = pixel.middle.ambient;
      instance_[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(std::max(0, pixel.middle.instance + 1));
    }
  }
}

// The fringes of several rays add up as vectors; the order is that of the ray that gives most light.
CodeCaster::Pixel CodeCaster::mixed(const vc::Caster& caster, int row, int col) const {
  constexpr float kShare = 1.0F / (kEdgeSide * kEdgeSide);
  std::complex<float> sum;
  vc::LightSample brightest;
  Pixel pixel =
      pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col)];
  pixel.ambient = 0.0F;
  for (int n = 0; n < kEdgeSide * kEdgeSide; ++n) {
    const auto offset = [](int i) { return (static_cast<float>(i) + 0.5F) / kEdgeSide - 0.5F; };
    const auto sample =
        caster.trace(rays_.at(row, col, offset(n / kEdgeSide), offset(n % kEdgeSide)), 1.0F / kEdgeSide);
    pixel.ambient += kShare * sample.ambient;
    if (sample.direct <= 0.0F) continue;
    sum += std::polar(kShare * sample.direct, static_cast<float>(2.0 * kPi) * sample.column_px / period_px_);
    if (sample.direct > brightest.direct) brightest = sample;
  }
  pixel.amplitude = std::abs(sum);
  if (pixel.amplitude > 0.0F) {
    const float phase_px = std::arg(sum) / static_cast<float>(2.0 * kPi) * period_px_;
    pixel.column_px = phase_px + period_px_ * std::round((brightest.column_px - phase_px) / period_px_);
  }
  return pixel;
}

void CodeCaster::mix_edges(const vc::Caster& caster) {
  std::vector<std::size_t> edges;
  const auto cols = static_cast<std::size_t>(cols_);
  for (int row = 1; row + 1 < rows_; ++row) {
    for (int col = 1; col + 1 < cols_; ++col) {
      const std::size_t i = static_cast<std::size_t>(row) * cols + static_cast<std::size_t>(col);
      const vc::LightSample& here = pixels_[i].middle;
      if (differ(here, pixels_[i - 1].middle) || differ(here, pixels_[i + 1].middle) ||
          differ(here, pixels_[i - cols].middle) || differ(here, pixels_[i + cols].middle))
        edges.push_back(i);
    }
  }
  for (const std::size_t i : edges) pixels_[i] = mixed(caster, static_cast<int>(i / cols), static_cast<int>(i % cols));
}

// The exposure that brings the brightest percentile of the parts to the wanted level in a white frame.
float CodeCaster::gain() const {
  std::vector<float> bright;
  const float around = static_cast<float>(options_.ambient_share) + kLightAround;
  for (const Pixel& pixel : pixels_) {
    if (pixel.middle.instance >= 0 && pixel.amplitude > 0.0F)
      bright.push_back(pixel.amplitude + around * pixel.ambient);
  }
  if (bright.empty()) return 1.0F;
  const auto percentile = bright.begin() + static_cast<std::ptrdiff_t>(bright.size() * 99 / 100);
  std::nth_element(bright.begin(), percentile, bright.end());
  return static_cast<float>(options_.white_level) / *percentile;
}

void CodeCaster::decode(float gain, Random& random) {
  const float around = static_cast<float>(options_.ambient_share) + kLightAround;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& pixel = pixels_[i];
    const float white = gain * (pixel.amplitude + around * pixel.ambient);
    modulation_[i] = 0.5F * kContrast * kFullLevel * gain * pixel.amplitude;
    texture_[i] = static_cast<std::uint8_t>(std::min(kFullLevel, kFullLevel * white));
    const float sigma_px = noise_.sigma_px(modulation_[i], texture_[i]);
    state_[i] = white > kSaturated        ? PixelState::kSaturated
                : pixel.amplitude <= 0.0F ? PixelState::kDark
                : sigma_px > kMostNoisePx ? PixelState::kLowModulation
                                          : PixelState::kValid;
    const float noise_px = sigma_px * static_cast<float>(normal(random));
    const bool off = random.uniform() < kPeriodErrors;
    column_px_[i] = state_[i] == PixelState::kValid ? pixel.column_px + noise_px + (off ? period_px_ : 0.0F)
                                                    : std::numeric_limits<float>::quiet_NaN();
  }
}

// Up to six highlights so strong that their surroundings are lost, too.
void CodeCaster::put_glare(Random& random) {
  for (int n = static_cast<int>(random.below(7)); n > 0; --n) {
    const std::size_t middle = random.below(static_cast<std::uint32_t>(pixels_.size()));
    const double radius_px = random.uniform(0.003, 0.012) * cols_;
    if (instance_[middle] == 0) continue;
    const int row0 = static_cast<int>(middle) / cols_, col0 = static_cast<int>(middle) % cols_;
    const int reach = static_cast<int>(radius_px);
    for (int row = std::max(0, row0 - reach); row <= std::min(rows_ - 1, row0 + reach); ++row) {
      for (int col = std::max(0, col0 - reach); col <= std::min(cols_ - 1, col0 + reach); ++col) {
        if (std::hypot(row - row0, col - col0) > radius_px) continue;
        const std::size_t i =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
        state_[i] = PixelState::kSaturated;
        column_px_[i] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

}  // namespace beltpick::bench
