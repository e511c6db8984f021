// What disturbs a capture: bounced light, a blurred camera, a projector out of step, faulty frames, a rig that drifts.
#include <catch2/catch.hpp>
#include <cmath>

#include "contract/sequences.hpp"
#include "virtual_cell/render/camera_blur.hpp"
#include "virtual_cell/render/capture_faults.hpp"
#include "virtual_cell/render/pattern_light.hpp"
#include "virtual_cell/render/scene_renderer.hpp"
#include "virtual_cell/render/target_shapes.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

TEST_CASE("light bounced off a wall onto the floor before it is what the view factor says") {
  RigOptions small;
  small.camera_width = 640;
  small.camera_height = 480;
  const Rig rig = make_rig(small).value();
  // A long white wall on the white belt, facing the projector, which stands on the belt's +x side.
  constexpr double kHeight = 60.0;
  const std::vector<ScenePart> parts{make_block("wall", {10.0, 280.0, kHeight}).value()};
  Pose<frame::Belt, frame::Part> standing;
  standing.translation_mm = {-40.0, 0.0, 0.0};
  RenderOptions options;
  options.background = Background::kPlane;
  options.noise = false;
  options.ambient_share = 0.0;
  options.white_level = 0.6;
  options.projector_gamma = 1.0;
  FrameSpec white;
  white.kind = FrameKind::kWhite;
  const auto render = [&](double interreflection) {
    options.interreflection = interreflection;
    SceneRenderer renderer(rig, parts, options);
    renderer.place(std::vector<PartInstance>{{0, rig.T_camera_belt * standing}}, 1);
    std::vector<std::uint8_t> pixels(640 * 480);
    renderer.expose(white, options.nominal_exposure_us, 5.0, {pixels.data(), 480, 640});
    return pixels;
  };
  const auto without = render(0.0), with = render(1.0), half = render(0.5);
  const Vec3 projector = rig.T_camera_belt.inverse() * rig.T_projector_camera.inverse().translation_mm;
  // The share of a matt surface's white that the projector's direction gives it.
  const auto lit = [&](const Vec3& point, const Vec3& normal) {
    const Vec3 to = projector - point;
    const Vec3 in_projector = rig.T_projector_camera * rig.T_camera_belt * point;
    return normal.dot(to.normalized()) / to.squaredNorm() * std::pow(in_projector.normalized().z(), 3.0);
  };
  for (const double away : {12.0, 25.0, 45.0}) {
    const Vec3 place(-35.0 + away, 5.0, 0.0);
    const Eigen::Vector2d pixel = rig.camera.project(rig.T_camera_belt * place);
    double direct = 0.0, bounced = 0.0, scaled = 0.0;
    for (int row = -3; row <= 3; ++row) {
      for (int col = -1; col <= 1; ++col) {
        const std::size_t at =
            static_cast<std::size_t>(std::lround(pixel.y()) + row) * 640 + std::lround(pixel.x()) + col;
        direct += without[at];
        bounced += with[at] - without[at];
        scaled += half[at] - without[at];
      }
    }
    // Each strip of the wall, all of it in view, adds its radiance (0.78 / pi of its light) times its view factor.
    double expected = 0.0;
    for (int i = 0; i < 600; ++i) {
      const double low = kHeight * i / 600, high = kHeight * (i + 1) / 600;
      const double factor = 0.5 * (away / std::hypot(away, low) - away / std::hypot(away, high));
      expected += 0.78 * factor * lit({-35.0, 5.0, 0.5 * (low + high)}, Vec3::UnitX());
    }
    expected /= lit(place, Vec3::UnitZ());
    CHECK(bounced / direct == Approx(expected).epsilon(0.12));
    CHECK(scaled == Approx(0.5 * bounced).epsilon(0.12));
  }
}

TEST_CASE("the camera's blur keeps the light and has the width asked for") {
  for (const double sigma : {0.3, 0.5, 0.8, 2.5}) {
    CameraBlur blur(sigma);
    std::vector<float> image(41 * 45, 0.0F);
    image[20 * 45 + 22] = 1.0F;
    blur.apply(image, 41, 45);
    double sum = 0.0, across = 0.0, down = 0.0;
    for (int row = 0; row < 41; ++row) {
      for (int col = 0; col < 45; ++col) {
        const double value = image[static_cast<std::size_t>(row) * 45 + col];
        sum += value;
        across += value * (col - 22) * (col - 22);
        down += value * (row - 20) * (row - 20);
      }
    }
    CHECK(sum == Approx(1.0).margin(1e-4));
    CHECK(std::sqrt(across) == Approx(sigma).epsilon(0.01));
    CHECK(std::sqrt(down) == Approx(sigma).epsilon(0.01));
  }
  CameraBlur none(0.0);
  std::vector<float> image{1.0F, 2.0F, 3.0F, 4.0F};
  none.apply(image, 2, 2);
  CHECK(image == std::vector<float>{1.0F, 2.0F, 3.0F, 4.0F});
  // Even light stays even up to the border.
  CameraBlur wide(2.0);
  std::vector<float> even(20 * 30, 0.5F);
  wide.apply(even, 20, 30);
  for (const float value : even) CHECK(value == Approx(0.5).margin(1e-5));
}

TEST_CASE("a free-running projector gives its mean over whole frames, and more or less within one") {
  const PatternLight light({912, 1140}, 1.0);
  const auto whole = light.pulsed(3.0, 0.37);
  double mean = 0.0, least = 1e9, most = 0.0;
  for (const int value : {0, 1, 100, 128, 255}) CHECK(whole[value] == Approx(value / 255.0).margin(1e-4));
  constexpr int kPhases = 1000;
  for (int i = 0; i < kPhases; ++i) {
    const double shown = light.pulsed(1.3, static_cast<double>(i) / kPhases)[128];
    mean += shown / kPhases;
    least = std::min(least, shown);
    most = std::max(most, shown);
  }
  CHECK(mean == Approx(128.0 / 255.0).epsilon(0.01));
  CHECK(most > 1.2 * least);
}

TEST_CASE("a projector out of focus takes the contrast that a Gaussian takes") {
  FrameSpec fringe;
  fringe.kind = FrameKind::kPhase;
  fringe.period_px = 16.0;
  fringe.steps = 4;
  const auto contrast = [&](double blur_px) {
    PatternLight light({912, 1140}, 1.0, blur_px);
    light.set(fringe);
    return light.at(16.0F * 20, 0) - light.at(16.0F * 20 + 8.0F, 0);
  };
  const double wave = 2.0 * 3.14159265358979 / 16.0;
  CHECK(contrast(3.0) / contrast(0.0) == Approx(std::exp(-0.5 * 9.0 * wave * wave)).epsilon(0.01));
}

TEST_CASE("faulty captures show the frames they should") {
  const Sequence sequence = make_sequence(SequenceName::kFast, {912, 1140}, SequenceAxes::kColumn).value();
  const int frames = static_cast<int>(sequence.frames.size());
  // The number of the frame that is shown at each image; -1 is dark.
  const auto shown = [&](const std::vector<std::string>& words) {
    CaptureFaults faults;
    for (const std::string& word : words) REQUIRE(faults.add(word));
    REQUIRE(faults.check(frames));
    std::vector<int> numbers;
    for (int i = 0; i < frames; ++i) {
      const FrameSpec frame = faults.shown(sequence, i);
      numbers.push_back(-1);
      for (int k = 0; k < frames; ++k) {
        if (sequence.frames[k].file == frame.file) numbers.back() = k;
      }
    }
    return numbers;
  };
  std::vector<int> right;
  for (int i = 0; i < frames; ++i) right.push_back(i);
  CHECK(shown({}) == right);
  auto expected = right;
  std::swap(expected[5], expected[7]);
  CHECK(shown({"swap:5,7"}) == expected);
  expected = right;
  expected[4] = 3;
  CHECK(shown({"repeat:4"}) == expected);
  expected = right;
  expected[0] = -1;
  CHECK(shown({"black:0"}) == expected);
  expected = right;
  for (int i = 6; i < frames; ++i) expected[i] = i + 1 < frames ? i + 1 : -1;
  CHECK(shown({"drop:6"}) == expected);
  expected = right;
  for (int i = 0; i < frames; ++i) expected[i] = (i + frames - 1) % frames;
  CHECK(shown({"shift:1"}) == expected);
  expected = right;
  for (int i = 3; i < frames; ++i) expected[i] = (i + 2) % frames;
  CHECK(shown({"shift:-2@3"}) == expected);

  CaptureFaults moved;
  REQUIRE(moved.add("move-mm:0.5@4"));
  REQUIRE(moved.add("creep-mm:-1.1"));
  CHECK(moved.belt_shift_mm(0, 12) == Approx(0.0));
  CHECK(moved.belt_shift_mm(3, 12) == Approx(-0.3));
  CHECK(moved.belt_shift_mm(11, 12) == Approx(-0.6));
  CHECK(!moved.capped());
  REQUIRE(moved.add("lens-cap"));
  CHECK(moved.capped());

  CaptureFaults wrong;
  for (const char* word : {"drop", "drop:", "drop:x", "swap:1", "drop:3 ", "move-mm:1", "fire"})
    CHECK(!wrong.add(word));
  for (const char* word : {"drop:99", "repeat:0", "swap:0,99", "black:-1", "move-mm:1@99"}) {
    CaptureFaults beyond;
    REQUIRE(beyond.add(word));
    CHECK(!beyond.check(frames));
  }
}

TEST_CASE("a rig drifts by what it is told, and not otherwise") {
  const Rig rig = make_rig().value();
  const Rig same = drifted(rig, 0.0, 0.0, 4);
  CHECK(same.camera.fx_px == rig.camera.fx_px);
  CHECK(same.T_projector_camera == rig.T_projector_camera);
  const Rig warm = drifted(rig, 0.5, 0.2, 4);
  CHECK(std::hypot(warm.camera.cx_px - rig.camera.cx_px, warm.camera.cy_px - rig.camera.cy_px) == Approx(0.5));
  CHECK(std::hypot(warm.projector.cx_px - rig.projector.cx_px, warm.projector.cy_px - rig.projector.cy_px) ==
        Approx(0.5));
  CHECK(std::abs(warm.camera.fx_px / rig.camera.fx_px - 1.0) * rig.camera.width / 2 == Approx(0.5));
  CHECK((warm.T_projector_camera.translation_mm - rig.T_projector_camera.translation_mm).norm() == Approx(0.2));
}
