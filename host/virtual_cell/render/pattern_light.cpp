#include "virtual_cell/render/pattern_light.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "contract/sequences.hpp"

namespace beltpick::virtual_cell {
namespace {

// Share of a pixel centred `offset` away under a Gaussian of `sigma`.
float pixel_share(double offset, double sigma) {
  const auto below = [sigma](double x) { return 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))); };
  return static_cast<float>(below(offset + 0.5) - below(offset - 0.5));
}

}  // namespace

PatternLight::PatternLight(const ProjectorGrid& grid, double gamma, double blur_px) : grid_(grid) {
  constexpr double kReachSigma = 4.6;
  const double widest = std::hypot(static_cast<double>(kSigmaFirst + kSigmaStep * (kBlurLevels - 1)), blur_px);
  reach_ = static_cast<int>(std::ceil(kReachSigma * widest));
  for (std::size_t value = 0; value < gamma_response_.size(); ++value) {
    gamma_response_[value] = static_cast<float>(std::pow(static_cast<double>(value) / 255.0, gamma));
  }
  response_ = gamma_response_;
  for (int parity = 0; parity < 2; ++parity) {
    for (int level = 0; level < kBlurLevels; ++level) {
      const double sigma =
          std::hypot(static_cast<double>(kSigmaFirst + kSigmaStep * static_cast<float>(level)), blur_px);
      for (int sub = 0; sub < kSubdivision; ++sub) {
        for (int n = -reach_; n <= reach_; ++n) {
          const double offset = n + 0.5 * parity - static_cast<double>(sub) / kSubdivision;
          weights_[parity][level][sub].push_back(pixel_share(offset, sigma));
        }
      }
    }
  }
}

void PatternLight::set(const FrameSpec& frame) {
  axis_ = frame.axis;
  samples_ = (grid_.extent(axis_) + 1) * kSubdivision;
  table_.assign(static_cast<std::size_t>(kBlurLevels) * samples_, 0.0F);
  mean_ = 0.0F;
  const bool two_kinds = grid_.layout == ProjectorLayout::kDiamond && axis_ == Axis::kColumn;
  for (int parity = 0; parity < (two_kinds ? 2 : 1); ++parity) add_rows(frame, parity, two_kinds ? 0.5F : 1.0F);
}

void PatternLight::add_rows(const FrameSpec& frame, int parity, float share) {
  const int extent = grid_.extent(axis_);
  const int padding = reach_ + static_cast<int>(kMargin);
  pixel_.assign(static_cast<std::size_t>(extent + 2 * padding + 1), 0.0F);
  for (int x = 0; x < extent; ++x) {
    // The pattern image holds 8 bits; the response is what the projector makes of them.
    const auto value = static_cast<std::size_t>(std::lround(255.0 * pattern_intensity(frame, x + 0.5 * parity)));
    pixel_[x + padding] = share * (kBlack + (1.0F - kBlack) * response_[value]);
  }
  mean_ += std::accumulate(pixel_.begin(), pixel_.end(), 0.0F) / static_cast<float>(extent);
  for (int level = 0; level < kBlurLevels; ++level) {
    float* out = table_.data() + static_cast<std::size_t>(level) * samples_;
    for (int sample = 0; sample < samples_; ++sample) {
      const auto& weight = weights_[parity][level][sample % kSubdivision];
      out[sample] += std::inner_product(weight.begin(), weight.end(), pixel_.begin() + sample / kSubdivision, 0.0F);
    }
  }
}

PatternLight::Response PatternLight::pulsed(double frames, double phase) const {
  constexpr double kLitShare = 11.0 / 12.0;
  // The time that a bit plane, from `begin` for `length` of each frame, is open within the exposure.
  const auto open = [&](double begin, double length) {
    const auto until = [&](double time) {
      const double whole = std::floor(time);
      return whole * length + std::clamp(time - whole - begin, 0.0, length);
    };
    return until(phase + frames) - until(phase);
  };
  std::array<double, 8> bit_light{};
  double begin = 0.0;
  for (int bit = 7; bit >= 0; --bit) {
    const double length = kLitShare * (1 << bit) / 255.0;
    bit_light[static_cast<std::size_t>(bit)] = open(begin, length) / (frames * kLitShare);
    begin += length;
  }
  Response response{};
  for (std::size_t value = 0; value < response.size(); ++value) {
    // The bits shown are those of the value that gamma leaves.
    const auto shown = static_cast<unsigned>(std::lround(255.0F * gamma_response_[value]));
    double light = 0.0;
    for (std::size_t bit = 0; bit < 8; ++bit) light += ((shown >> bit) & 1U) != 0 ? bit_light[bit] : 0.0;
    response[value] = static_cast<float>(light);
  }
  return response;
}

int PatternLight::blur_level(float sigma_px) {
  const auto level = static_cast<int>(std::lround((sigma_px - kSigmaFirst) / kSigmaStep));
  return std::clamp(level, 0, kBlurLevels - 1);
}

}  // namespace beltpick::virtual_cell
