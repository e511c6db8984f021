// Every pixel that is not measured says why, and the reasons have their order.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.hpp"
#include "contract/exposures.hpp"
#include "contract/sequences.hpp"
#include "unit/decode/synthetic.hpp"

namespace beltpick::testing {
namespace {

constexpr ProjectorGrid kGrid{320, 240};
constexpr int kRows = 8;
constexpr int kCols = 300;

// One kind of pixel all over.
Scene even_scene(double gain, double ambient) {
  Scene scene{kRows, kCols, {}, {}, {}, {}};
  for (int i = 0; i < kRows * kCols; ++i) {
    scene.column_px.push_back(0.5 + (i % kCols) * 1.05);
    scene.row_px.push_back(100.0);
    scene.gain.push_back(gain);
    scene.ambient.push_back(ambient);
  }
  return scene;
}

// Half of the pixels are well lit, so that the capture as a whole is a good one.
Scene half_scene(double gain, double ambient) {
  Scene scene = even_scene(gain, ambient);
  for (std::size_t i = 0; i < scene.gain.size() / 2; ++i) {
    scene.gain[i] = 150.0;
    scene.ambient[i] = 8.0;
  }
  return scene;
}

struct Decoded {
  std::vector<PixelState> state;
  std::vector<float> column_px, sigma_px;

  // The share of the second half's pixels (or of the last 1 / part) of this state.
  [[nodiscard]] double share(PixelState wanted, std::size_t part = 2) const {
    const auto last = static_cast<std::ptrdiff_t>(state.size() / part);
    return static_cast<double>(std::count(state.end() - last, state.end(), wanted)) / static_cast<double>(last);
  }
};

Decoded decode(const Sequence& sequence, const Images& images, const Imaging& imaging) {
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE(plan);
  OwnDecoder decoder(*plan, images.rows, images.cols, 1);
  const auto code = decode_images(decoder, *plan, images, imaging);
  if (!code) FAIL(code.error().detail);
  Decoded decoded;
  for (std::size_t i = 0; i < code->state.size(); ++i) {
    decoded.state.push_back(code->state.data[i]);
    decoded.column_px.push_back(code->column_px.data[i]);
    decoded.sigma_px.push_back(code->column_noise.sigma_px(code->modulation.data[i], code->texture.data[i]));
  }
  return decoded;
}

Decoded decode(const Sequence& sequence, const Scene& scene) {
  const Imaging imaging;
  return decode(sequence, image_sequence(sequence, scene, imaging), imaging);
}

Sequence phases_and_gray(bool references) {
  Sequence sequence{kGrid, {}, {}};
  if (references) sequence.frames = {plain_frame(FrameKind::kWhite), plain_frame(FrameKind::kBlack)};
  add_phases(sequence, Axis::kColumn, 20, 6);
  add_gray(sequence, Axis::kColumn, 10);
  return sequence;
}

Sequence gray_only() {
  Sequence sequence{kGrid, {plain_frame(FrameKind::kWhite), plain_frame(FrameKind::kBlack)}, {}};
  add_gray(sequence, Axis::kColumn, 2);
  return sequence;
}

TEST_CASE("dark, saturated and low modulation are told apart", "[states]") {
  const bool references = GENERATE(false, true);
  const Sequence sequence = phases_and_gray(references);
  CHECK(decode(sequence, half_scene(150.0, 10.0)).share(PixelState::kValid) > 0.99);
  CHECK(decode(sequence, half_scene(0.0, 4.0)).share(PixelState::kDark) == 1.0);
  CHECK(decode(sequence, half_scene(230.0, 60.0)).share(PixelState::kSaturated) > 0.9);
  // Light that the projector does not modulate: without a black frame it might be the projector's, out of focus.
  const PixelState bright_without = references ? PixelState::kDark : PixelState::kLowModulation;
  CHECK(decode(sequence, half_scene(2.0, 120.0)).share(bright_without) > 0.95);
}

TEST_CASE("a projector out of focus leaves light without modulation", "[states]") {
  const Sequence sequence = phases_and_gray(true);
  const Imaging sharp;
  Imaging blurred;
  blurred.blur_px = 10.0;  // a whole period
  const Scene scene = half_scene(150.0, 8.0);
  Images images = image_sequence(sequence, scene, sharp);
  const Images soft = image_sequence(sequence, scene, blurred);
  for (std::size_t f = 0; f < images.frames.size(); ++f) {
    const auto half = static_cast<std::ptrdiff_t>(images.frames[f].size() / 2);
    std::copy(soft.frames[f].begin() + half, soft.frames[f].end(), images.frames[f].begin() + half);
  }
  CHECK(decode(sequence, images, sharp).share(PixelState::kLowModulation) > 0.95);
}

TEST_CASE("Gray frames that contradict the phase make the order uncertain; saturation goes before", "[states]") {
  const Sequence sequence = phases_and_gray(true);
  const Imaging imaging;
  for (const double gain : {150.0, 330.0}) {
    const Scene scene = half_scene(gain, 8.0);
    Images images = image_sequence(sequence, scene, imaging);
    auto& finest = images.frames.back();  // as if the stripes of the finest cells stood elsewhere
    for (std::size_t i = finest.size() * 15 / 16; i < finest.size(); ++i) finest[i] = finest[i] > 80 ? 8 : 150;
    const Decoded decoded = decode(sequence, images, imaging);
    // Half of a wrong cell lies where a border's noise might have put a right one.
    CHECK(decoded.share(PixelState::kOrderUncertain, 16) > (gain < 200.0 ? 0.4 : -0.1));
    CHECK(decoded.share(PixelState::kSaturated, 16) >= (gain < 200.0 ? 0.0 : 0.9));
  }
}

TEST_CASE("a Gray code survives saturated white, and tells where black is saturated too", "[states]") {
  CHECK(decode(gray_only(), half_scene(250.0, 80.0)).share(PixelState::kValid) > 0.95);
  CHECK(decode(gray_only(), half_scene(200.0, 400.0)).share(PixelState::kSaturated) == 1.0);
}

TEST_CASE("exposures are merged: what one of them measures is measured, with the noise that is told", "[states]") {
  Random random(5);
  Scene scene = even_scene(1.0, 3.0);
  for (double& gain : scene.gain) gain = std::exp(random.uniform(std::log(6.0), std::log(900.0)));
  const Sequence base = phases_and_gray(false);
  const std::vector<double> exposures_us = {250.0, 1000.0, 4000.0};
  const auto hdr = at_exposures(base, exposures_us);
  REQUIRE(hdr);
  CHECK(hdr->frames.size() == 3 * base.frames.size());
  const Decoded single = decode(base, scene);
  const Decoded merged = decode(*hdr, scene);
  int valid = 0;
  int single_valid = 0;
  double squares = 0.0;
  for (std::size_t i = 0; i < merged.state.size(); ++i) {
    single_valid += single.state[i] == PixelState::kValid ? 1 : 0;
    if (merged.state[i] != PixelState::kValid) continue;
    ++valid;
    squares += std::pow((merged.column_px[i] - scene.column_px[i]) / merged.sigma_px[i], 2);
  }
  const auto all = static_cast<double>(merged.state.size());
  CHECK(single_valid / all < 0.75);
  CHECK(valid / all > 0.98);
  CHECK(std::sqrt(squares / valid) == Approx(1.0).margin(0.1));
}

TEST_CASE("exposures that disagree measure nothing", "[states]") {
  const Sequence base = phases_and_gray(false);
  const std::vector<double> exposures_us = {1000.0, 1400.0};
  const auto hdr = at_exposures(base, exposures_us);
  REQUIRE(hdr);
  const Scene scene = half_scene(120.0, 8.0);
  Scene moved = scene;
  for (double& x : moved.column_px) x += 3.0;
  const Imaging imaging;
  Images images = image_sequence(*hdr, scene, imaging);
  const Images later = image_sequence(*hdr, moved, imaging);
  for (std::size_t f = base.frames.size(); f < images.frames.size(); ++f) {
    const auto half = static_cast<std::ptrdiff_t>(images.frames[f].size() / 2);
    std::copy(later.frames[f].begin() + half, later.frames[f].end(), images.frames[f].begin() + half);
  }
  CHECK(decode(*hdr, images, imaging).share(PixelState::kOrderUncertain) > 0.95);
}

}  // namespace
}  // namespace beltpick::testing
