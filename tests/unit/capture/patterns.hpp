// A small sequence and what a camera would see of it: textured, noisy, flickering.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/image.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/capture.hpp"

namespace patterns {

using namespace beltpick;

inline FrameSpec frame(FrameKind kind) {
  FrameSpec spec;
  spec.kind = kind;
  return spec;
}

// 8 phase steps, 7 Gray bits, white, black: 17 frames on 912 columns.
inline Sequence standard() {
  Sequence sequence;
  sequence.projector = {912, 1140, ProjectorLayout::kSquare};
  for (int step = 0; step < 8; ++step) {
    FrameSpec spec = frame(FrameKind::kPhase);
    spec.period_px = 18;
    spec.steps = 8;
    spec.step = step;
    sequence.frames.push_back(spec);
  }
  for (int bit = 6; bit >= 0; --bit) {
    FrameSpec spec = frame(FrameKind::kGray);
    spec.cell_px = 9;
    spec.bit = bit;
    sequence.frames.push_back(spec);
  }
  sequence.frames.push_back(frame(FrameKind::kWhite));
  sequence.frames.push_back(frame(FrameKind::kBlack));
  return sequence;
}

inline double intensity(const FrameSpec& spec, double x) {
  switch (spec.kind) {
    case FrameKind::kPhase:
      return 0.5 + 0.5 * std::cos(2 * kPi * x / spec.period_px + spec.offset_rad + 2 * kPi * spec.step / spec.steps);
    case FrameKind::kGray: {
      const auto cell = static_cast<unsigned>((x + 0.5) / spec.cell_px);
      const bool bright = ((cell ^ (cell >> 1U)) >> static_cast<unsigned>(spec.bit) & 1U) != 0;
      return bright != spec.inverted ? 1.0 : 0.0;
    }
    case FrameKind::kWhite:
      return 1.0;
    default:
      return 0.0;
  }
}

struct View {
  double first_column = 40;  // of the projector, seen at the left border
  double columns = 800;
  double gain = 160;   // grey levels of white on the brightest texture
  double noise = 1.5;  // grey levels
};

// What the camera sees of one frame.
inline void render(ImageView<std::uint8_t> image, const FrameSpec& spec, const View& view, Random& random) {
  const double flicker = random.uniform(5.0, 8.0);
  for (int r = 0; r < image.rows; ++r) {
    for (int c = 0; c < image.cols; ++c) {
      const double x = view.first_column + view.columns * (c + 0.1 * r) / (image.cols + 0.1 * image.rows);
      const double texture = 0.6 + 0.4 * std::sin(0.05 * r) * std::cos(0.07 * c);
      // The sum of four uniform numbers is near enough to a Gaussian of this width.
      double noise = -2.0;
      for (int i = 0; i < 4; ++i) noise += random.uniform();
      const double grey = flicker + view.gain * texture * intensity(spec, x) + 1.73 * view.noise * noise;
      image(r, c) = static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0));
    }
  }
}

}  // namespace patterns
