// The renderer against slow geometry of the test's own, its noise against the model, its bits against the seed.
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "contract/sequences.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

// A small rig, so that a slow oracle can look at every triangle.
Rig small_rig() {
  RigOptions options;
  options.camera_width = 320;
  options.camera_height = 240;
  return make_rig(options).value();
}

const ScenePart& bracket() {
  static const ScenePart part = builtin_part("bracket").value();
  return part;
}

std::vector<PartInstance> one_bracket(const Rig& rig) {
  Pose<frame::Belt, frame::Part> T_belt_part;
  T_belt_part.rotation = Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
  T_belt_part.translation_mm = {10.0, -15.0, 0.0};
  return {{0, rig.T_camera_belt * T_belt_part}};
}

// Nearest hit of a ray with the triangles, by Cramer's rule on each; in lengths of `direction`.
std::optional<double> slow_hit(const Vec3& origin, const Vec3& direction, const PartInstance& placed, double nearest) {
  std::optional<double> hit;
  for (const auto& face : bracket().mesh.face) {
    const Vec3 a = placed.T_camera_part * bracket().mesh.vertex_mm[face[0]].cast<double>();
    Mat3 system;
    system.col(0) = placed.T_camera_part * bracket().mesh.vertex_mm[face[1]].cast<double>() - a;
    system.col(1) = placed.T_camera_part * bracket().mesh.vertex_mm[face[2]].cast<double>() - a;
    system.col(2) = -direction;
    const double det = system.determinant();
    if (std::abs(det) < 1e-12) continue;
    const Vec3 solution = system.inverse() * (origin - a);
    const bool inside = solution.x() >= 0 && solution.y() >= 0 && solution.x() + solution.y() <= 1;
    if (inside && solution.z() > nearest && (!hit || solution.z() < *hit)) hit = solution.z();
  }
  return hit;
}

double mean_of(const std::vector<std::uint8_t>& image) {
  double sum = 0.0;
  for (const std::uint8_t level : image) sum += level;
  return sum / static_cast<double>(image.size());
}

}  // namespace

TEST_CASE("points, instances, shadows and projector coordinates agree with slow ray casting") {
  const Rig rig = small_rig();
  SceneRenderer renderer(rig, {&bracket(), 1});
  const std::vector<PartInstance> placed = one_bracket(rig);
  renderer.place(placed, 5);
  const Vec3 up = rig.T_camera_belt.rotation.col(2);
  const Vec3 projector = rig.T_projector_camera.inverse().translation_mm;
  int on_part = 0;
  int in_shadow = 0;
  for (int row = 6; row < 240; row += 13) {
    for (int col = 5; col < 320; col += 13) {
      const Vec3 ray = rig.camera.ray({static_cast<double>(col), static_cast<double>(row)});
      const double belt = up.dot(rig.T_camera_belt.translation_mm) / up.dot(ray);
      const auto part = slow_hit(Vec3::Zero(), ray, placed[0], 0.0);
      const Vec3 point = ray * std::min(belt, part.value_or(belt));
      CHECK(renderer.true_instances()(row, col) == (part && *part < belt ? 1 : 0));
      CHECK((renderer.true_points_mm()(row, col).cast<double>() - point).norm() < 0.01);
      const Eigen::Vector2d pixel = rig.projector.project(rig.T_projector_camera * point);
      CHECK(renderer.true_column_px()(row, col) == Approx(pixel.x()).margin(0.02));
      CHECK(renderer.true_row_px()(row, col) == Approx(pixel.y()).margin(0.02));
      on_part += part && *part < belt ? 1 : 0;
      if (part) continue;  // on the part itself facets and grazing light make the shadow's border a matter of taste
      const auto between = slow_hit(point, projector - point, placed[0], 1e-6);
      CHECK(renderer.lit(row, col) == !(between && *between < 1.0));
      in_shadow += between && *between < 1.0 ? 1 : 0;
    }
  }
  CHECK(on_part > 10);
  CHECK(in_shadow > 1);
}

TEST_CASE("a phase frame shows the pattern at each pixel's projector coordinate") {
  const Rig rig = small_rig();
  RenderOptions options;
  options.background = Background::kPlane;
  options.noise = false;
  options.projector_gamma = 1.0;
  SceneRenderer renderer(rig, {&bracket(), 1}, options);
  std::vector<std::uint8_t> pixels(320 * 240);
  const ImageView<std::uint8_t> image(pixels.data(), 240, 320);
  // Eight steps give the phase whatever offset and shading; the projector coordinate follows from it.
  constexpr double kTwoPi = 6.283185307179586;
  std::vector<double> cosine(pixels.size()), sine(pixels.size());
  FrameSpec frame;
  frame.kind = FrameKind::kPhase;
  frame.period_px = 40;
  frame.steps = 8;
  for (frame.step = 0; frame.step < 8; ++frame.step) {
    renderer.expose(frame, options.nominal_exposure_us, 1.0, image);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      cosine[i] += pixels[i] * std::cos(kTwoPi * frame.step / 8);
      sine[i] -= pixels[i] * std::sin(kTwoPi * frame.step / 8);
    }
  }
  for (int row = 5; row < 240; row += 11) {
    for (int col = 5; col < 320; col += 11) {
      const std::size_t i = static_cast<std::size_t>(row) * 320 + col;
      const double coordinate = std::atan2(sine[i], cosine[i]) / kTwoPi * frame.period_px;
      CHECK(std::remainder(coordinate - renderer.true_column_px()(row, col), frame.period_px) ==
            Approx(0.0).margin(0.09));  // 8 bits of a dark corner
    }
  }
}

TEST_CASE("noise is that of ten thousand electrons, and independent from frame to frame") {
  const Rig rig = small_rig();
  RenderOptions options;
  options.background = Background::kPlane;
  SceneRenderer renderer(rig, {&bracket(), 1}, options);
  constexpr int kFrames = 60;
  std::vector<std::uint8_t> pixels(320 * 240);
  const ImageView<std::uint8_t> image(pixels.data(), 240, 320);
  FrameSpec white;
  white.kind = FrameKind::kWhite;
  std::vector<double> sum(pixels.size()), squares(pixels.size()), neighbours(pixels.size());
  std::vector<std::uint8_t> previous(pixels.size());
  for (int n = 0; n < kFrames; ++n) {
    // Whole periods of the flicker, long after the stop: only the sensor's noise is left.
    renderer.expose(white, 8000.0, 10.0 + n * 0.01, image);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      sum[i] += pixels[i];
      squares[i] += static_cast<double>(pixels[i]) * pixels[i];
      if (n > 0) neighbours[i] += static_cast<double>(pixels[i]) * previous[i];
    }
    previous = pixels;
  }
  double measured = 0.0, expected = 0.0, covariance = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double mean = sum[i] / kFrames;
    if (mean > 235.0) continue;
    const double level_per_electron = 255.0 / kFullWellElectrons;
    measured += (squares[i] - sum[i] * mean) / (kFrames - 1);
    expected += level_per_electron * level_per_electron *
                    (mean / level_per_electron + kReadNoiseElectrons * kReadNoiseElectrons) +
                1.0 / 12.0;
    covariance += neighbours[i] / (kFrames - 1) - mean * mean;
  }
  CHECK(measured == Approx(expected).epsilon(0.02));
  CHECK(std::abs(covariance) < 0.05 * expected);
}

TEST_CASE("white reaches its level on the brightest percentile of the parts") {
  const Rig rig = small_rig();
  SceneRenderer renderer(rig, {&bracket(), 1});
  renderer.place(one_bracket(rig), 9);
  std::vector<std::uint8_t> pixels(320 * 240);
  const ImageView<std::uint8_t> image(pixels.data(), 240, 320);
  FrameSpec white;
  white.kind = FrameKind::kWhite;
  renderer.expose(white, 8000.0, 1.0, image);
  std::vector<int> levels;
  for (int row = 0; row < 240; ++row) {
    for (int col = 0; col < 320; ++col) {
      if (renderer.true_instances()(row, col) != 0 && renderer.lit(row, col)) levels.push_back(image(row, col));
    }
  }
  std::sort(levels.begin(), levels.end());
  const double level = levels[levels.size() * 99 / 100] / 255.0;
  CHECK(level > 0.85);
  CHECK(level < 0.90);
}

TEST_CASE("the same seed gives the same bits, another seed others") {
  const Rig rig = small_rig();
  std::vector<std::uint8_t> first(320 * 240), second(320 * 240), other(320 * 240);
  FrameSpec white;
  white.kind = FrameKind::kWhite;
  const auto expose = [&](std::uint64_t seed, std::vector<std::uint8_t>& pixels) {
    SceneRenderer renderer(rig, {&bracket(), 1});
    renderer.place(one_bracket(rig), seed);
    renderer.expose(white, 8000.0, 0.3, {pixels.data(), 240, 320});
  };
  expose(3, first);
  expose(3, second);
  expose(4, other);
  CHECK(first == second);
  CHECK(first != other);
}

TEST_CASE("a longer exposure is brighter in proportion; black is nearly dark; a moving belt moves the picture") {
  const Rig rig = small_rig();
  RenderOptions options;
  options.noise = false;
  SceneRenderer renderer(rig, {&bracket(), 1}, options);
  renderer.place(one_bracket(rig), 2);
  std::vector<std::uint8_t> half(320 * 240), full(320 * 240), black(320 * 240), moved(320 * 240);
  FrameSpec frame;
  frame.kind = FrameKind::kWhite;
  renderer.expose(frame, 3000.0, 1.0, {half.data(), 240, 320});
  renderer.expose(frame, 6000.0, 1.0, {full.data(), 240, 320});
  CHECK(mean_of(full) == Approx(2.0 * mean_of(half)).epsilon(0.03));
  // At 320 pixels for 400 mm, 12.5 mm are about ten pixels.
  renderer.expose(frame, 6000.0, 1.0, {moved.data(), 240, 320}, 12.5);
  int same = 0, compared = 0;
  for (int row = 60; row < 180; ++row) {
    for (int col = 100; col < 200; ++col) {
      const int here = full[static_cast<std::size_t>(row) * 320 + col];
      same += std::abs(here - moved[static_cast<std::size_t>(row) * 320 + col + 10]) < 25 ? 1 : 0;
      ++compared;
    }
  }
  CHECK(same > compared * 9 / 10);
  frame.kind = FrameKind::kBlack;
  renderer.expose(frame, 6000.0, 1.0, {black.data(), 240, 320});
  CHECK(mean_of(black) < 0.15 * mean_of(full));
}

TEST_CASE("the visible fraction counts what the border cuts off") {
  const Rig rig = small_rig();
  SceneRenderer renderer(rig, {&bracket(), 1});
  std::vector<PartInstance> placed = one_bracket(rig);
  renderer.place(placed, 1);
  CHECK(renderer.visible_fractions().at(0) == Approx(1.0));
  // The edge of the view runs through its middle.
  const Vec3 edge = rig.camera.ray({319.5, 120.0});
  placed[0].T_camera_part.translation_mm = edge * (rig.T_camera_belt.translation_mm.z() - 5.0);
  renderer.place(placed, 1);
  CHECK(renderer.visible_fractions().at(0) > 0.25);
  CHECK(renderer.visible_fractions().at(0) < 0.75);
}
