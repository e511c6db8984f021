// PatternLight: how bright the projector shines at each of its coordinates while one frame of the sequence stands.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "contract/capture.hpp"

namespace beltpick::virtual_cell {

// The projected light between the pixels: pixel shape and defocus at kBlurLevels strengths, gamma, and the projector's
// black level. Built anew for each frame in about a millisecond.
class PatternLight {
 public:
  static constexpr int kBlurLevels = 8;
  static constexpr int kSubdivision = 8;  // samples a projector pixel; read with linear interpolation
  static constexpr float kBlack = 0.003F;

  // `blur_px`: standard deviation of a defocus of the whole image, added to that of every level.
  PatternLight(const ProjectorGrid& grid, double gamma, double blur_px = 0.0);

  void set(const FrameSpec& frame);

  // Light of each of the 256 pattern values; gamma's own until set. Takes effect with the next set().
  using Response = std::array<float, 256>;
  void set_response(const Response& response) { response_ = response; }
  // What a projector that dims by pulses shows to an exposure of `frames` of its frames, begun at `phase` (0..1) of
  // one: in its frame it shows the value's bits one after the other, the longest first, and is dark for a twelfth.
  [[nodiscard]] Response pulsed(double frames, double phase) const;

  // Light at a coordinate along the axis of the frame. Zero beyond the projector's image.
  [[nodiscard]] float at(float coordinate_px, int blur_level) const {
    const float place = (coordinate_px + kMargin) * kSubdivision;
    const int index = static_cast<int>(place);
    if (!(place >= 0.0F) || index + 1 >= samples_) return 0.0F;
    const float* value = table_.data() + static_cast<std::size_t>(blur_level) * samples_ + index;
    return value[0] + (place - static_cast<float>(index)) * (value[1] - value[0]);
  }
  // Mean over the projector's image: what light scattered about the scene carries.
  [[nodiscard]] float mean() const { return mean_; }
  [[nodiscard]] Axis axis() const { return axis_; }

  // The blur level for a standard deviation of the defocus in projector pixels.
  static int blur_level(float sigma_px);

 private:
  static constexpr float kMargin = 1.0F;  // of coordinates before pixel 0 that the table covers
  static constexpr float kSigmaFirst = 0.40F, kSigmaStep = 0.16F;

  ProjectorGrid grid_;
  Response gamma_response_{};
  Response response_{};
  Axis axis_ = Axis::kColumn;
  int reach_ = 0;  // pixels either side that the widest blur mixes in
  int samples_ = 0;
  float mean_ = 0.0F;
  std::vector<float> pixel_;
  std::vector<float> table_;  // [level][sample]
  // Share of the neighbouring pixels at each subdivision and blur; [1] for the odd rows of a diamond lattice.
  using Weights = std::array<std::array<std::vector<float>, kSubdivision>, kBlurLevels>;
  std::array<Weights, 2> weights_;

  // Adds `share` of the light of the even (0) or odd (1) rows to the table.
  void add_rows(const FrameSpec& frame, int parity, float share);
};

}  // namespace beltpick::virtual_cell
