// Verification: the true pose passes, wrong ones do not, whatever their residual.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "result/outline.hpp"
#include "result/rivalry.hpp"
#include "result/verdict.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

// A part lying on the belt, its image, and the drawing that poses are judged with.
struct Bench {
  Shape shape;
  LoadedPart loaded;
  result::PartPose truth;
  SceneImage image;
  InArena<result::Drawing> drawing;

  explicit Bench(Shape of, const Mat3& rotation = Mat3::Identity(), double x_mm = 10.0)
      : shape(std::move(of)),
        loaded(shape),
        truth(on_belt(shape, loaded.part, rotation, x_mm, -15.0)),
        image(render({{&shape, truth}})),
        drawing(test_limits()) {}

  result::Scene scene() {
    result::Scene scene;
    scene.range = image.range();
    scene.labels = image.labels();
    scene.lens = image.lens;
    scene.belt = image.belt;
    return scene;
  }
  result::Evidence evidence(const result::PartPose& pose) {
    drawing.made.draw(loaded.model().fine, pose, image.lens);
    static constexpr std::array<std::uint16_t, 1> kLabel{1};
    return result::weigh(drawing.made, loaded.model(), pose, scene(), {image.labels(), kLabel});
  }
  Result<void> verdict(const result::PartPose& pose) {
    const double tolerance_mm = result::surface_tolerance_mm(scene(), loaded.model().spacing_mm);
    return result::judge(evidence(pose), tolerance_mm, {});
  }
  // The true pose, then turned about an axis of the part through its centre.
  [[nodiscard]] result::PartPose turned(const Vec3& axis, double angle) const {
    const Vec3 centre = loaded.model().centre_mm;
    const Mat3 turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    return truth * Pose<frame::Part, frame::Part>{turn, centre - turn * centre};
  }
};

}  // namespace

TEST_CASE("the true pose is believed") {
  for (const auto& shape : {bracket(), knuckle(), sheet(), flange()}) {
    Bench bench(shape);
    const auto e = bench.evidence(bench.truth);
    INFO(shape.name);
    CHECK(bench.verdict(bench.truth));
    CHECK(e.coverage > 0.65);  // the rest lies in shadows
    CHECK(e.violated < 0.01);
    CHECK(e.contradicted < 0.01);
    CHECK(e.in_view > 0.99);
    CHECK(e.rms_mm < 0.1);
  }
}

TEST_CASE("poses flipped, turned or shifted are not believed") {
  Bench bench(bracket());
  CHECK_FALSE(bench.verdict(bench.turned(Vec3::UnitX(), kPi)));
  CHECK_FALSE(bench.verdict(bench.turned(Vec3::UnitZ(), kPi)));
  CHECK_FALSE(bench.verdict(bench.turned(Vec3::UnitZ(), kPi / 2)));
  CHECK_FALSE(bench.verdict(bench.turned(Vec3::UnitY(), 0.1)));
  result::PartPose shifted = bench.truth;
  shifted.translation_mm.x() += 12.0;
  CHECK_FALSE(bench.verdict(shifted));
  shifted = bench.truth;
  shifted.translation_mm.z() += 8.0;  // under the belt, hidden behind what was measured
  CHECK_FALSE(bench.verdict(shifted));
  shifted.translation_mm.z() -= 16.0;  // hovering
  CHECK_FALSE(bench.verdict(shifted));
}

TEST_CASE("the less of a part is measured, the fewer gaps are forgiven") {
  const auto verdict = [](double support, double gaps) {
    result::Evidence evidence;
    evidence.points = 1000;
    evidence.in_view = 1.0;
    evidence.support = support;
    evidence.gaps = gaps;
    evidence.coverage = support / (support + gaps);
    return result::judge(evidence, 0.5, {});
  };
  CHECK(verdict(0.75, 0.25));
  CHECK(verdict(0.35, 0.02));
  const auto gappy = verdict(0.37, 0.11);
  REQUIRE_FALSE(gappy);
  CHECK(gappy.error().code == ResultCode::kCoverageTooLow);
}

TEST_CASE("a mirrored part is not taken for the part") {
  const Shape original = bracket();
  const LoadedPart loaded(original);
  Bench bench(mirrored(original));
  for (const double angle : {0.0, kPi}) {
    const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
    const result::PartPose pose = bench.truth * Pose<frame::Part, frame::Part>{turn, Vec3::Zero()};
    bench.drawing.made.draw(loaded.model().fine, pose, bench.image.lens);
    const std::array<std::uint16_t, 1> label{1};
    const auto e =
        result::weigh(bench.drawing.made, loaded.model(), pose, bench.scene(), {bench.image.labels(), label});
    CHECK_FALSE(result::judge(e, result::surface_tolerance_mm(bench.scene(), loaded.model().spacing_mm), {}));
  }
}

TEST_CASE("a face that fits inside a larger object is not the part") {
  Bench bench(plate());
  const LoadedPart small(block());
  // The block's top in the plate's top.
  const result::PartPose pose = bench.truth * Pose<frame::Part, frame::Part>{Mat3::Identity(), {0.0, 0.0, 6.0 - 15.0}};
  bench.drawing.made.draw(small.model().fine, pose, bench.image.lens);
  result::Scene scene = bench.scene();
  scene.belt.reset();
  const auto e = result::weigh(bench.drawing.made, small.model(), pose, scene);
  CHECK(e.coverage > 0.8);
  CHECK(e.continued > 0.8);
  CHECK_FALSE(result::judge(e, result::surface_tolerance_mm(scene, small.model().spacing_mm), {}));
}

TEST_CASE("that a part's edges are rounded off does not hide that the object goes on") {
  Bench bench(plate());
  Shape rounded = block();
  rounded.distance = [](const Vec3& at) {
    constexpr double kRadius_mm = 2.5;
    const Vec3 beyond = at.cwiseAbs() - (Vec3(40.0, 25.0, 15.0) - Vec3::Constant(kRadius_mm));
    return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0) - kRadius_mm;
  };
  const LoadedPart small(rounded);
  const result::PartPose pose = bench.truth * Pose<frame::Part, frame::Part>{Mat3::Identity(), {0.0, 0.0, 6.0 - 15.0}};
  bench.drawing.made.draw(small.model().fine, pose, bench.image.lens);
  CHECK(result::continued_outline(bench.drawing.made, small.model(), pose, bench.scene(), 0.6) > 0.8);

  Bench itself(rounded);
  itself.drawing.made.draw(small.model().fine, itself.truth, itself.image.lens);
  CHECK(result::continued_outline(itself.drawing.made, small.model(), itself.truth, itself.scene(), 0.6) < 0.05);
}

TEST_CASE("a part mostly out of the image is withheld as such") {
  Bench bench(bracket(), Mat3::Identity(), 235.0);
  const auto verdict = bench.verdict(bench.truth);
  REQUIRE_FALSE(verdict);
  CHECK(verdict.error().code == ResultCode::kPartlyOutOfView);
}

TEST_CASE("a first impression tells a pose that is measured from one that is seen to be empty") {
  Bench bench(flange());
  const PartModel& model = bench.loaded.model();
  const double tolerance_mm = 3.0 * result::surface_tolerance_mm(bench.scene(), model.spacing_mm);
  const auto right = result::first_impression(model, bench.truth, bench.scene(), tolerance_mm);
  CHECK(right.score > 0.75);
  CHECK(right.seen_empty < 0.02);
  result::PartPose before = bench.truth;
  before.translation_mm.z() -= 40.0;
  const auto empty = result::first_impression(model, before, bench.scene(), tolerance_mm);
  CHECK(empty.score < -1.0);
  CHECK(empty.seen_empty > 0.7);
}

TEST_CASE("two poses are compared wherever either part appears, and counted as pixel by pixel") {
  Bench bench(flange());
  const PartModel& model = bench.loaded.model();
  result::PartPose aside = bench.truth;
  aside.translation_mm += Vec3(25.0, -10.0, 0.0);
  const result::Scene scene = bench.scene();
  const auto holds = [&](const result::PartPose& pose, int row, int col) {
    const Vec3f at = (pose.inverse() * scene.range.point_mm(row, col).cast<double>()).cast<float>();
    const OrientedPoint& nearest = model.nearest(at);
    const double tolerance_mm = result::surface_tolerance_mm(scene, model.spacing_mm);
    return std::abs(nearest.normal.dot(at - nearest.point_mm)) < tolerance_mm &&
           (at - nearest.point_mm).norm() < 1.5 * model.spacing_mm + tolerance_mm;
  };
  result::Rivalry expected;
  for (int row = 0; row < scene.labels.rows; row += 3) {
    for (int col = 0; col < scene.labels.cols; col += 3) {
      if (scene.labels(row, col) == 0 || !scene.range.valid(row, col)) continue;
      const bool first = holds(bench.truth, row, col), second = holds(aside, row, col);
      expected.both += first && second ? 1 : 0;
      expected.only_first += first && !second ? 1 : 0;
      expected.only_second += second && !first ? 1 : 0;
    }
  }
  REQUIRE(expected.only_first > 50);
  REQUIRE(expected.both > 50);
  const auto counted = result::compare({model, bench.truth}, {model, aside}, scene, 3);
  CHECK(std::abs(counted.both - expected.both) <= 2);
  CHECK(std::abs(counted.only_first - expected.only_first) <= 2);
  CHECK(std::abs(counted.only_second - expected.only_second) <= 2);
}

TEST_CASE("of two poses the picture prefers the true one, and cannot choose between equals") {
  Bench bench(flange());
  const result::Rival truth{bench.loaded.model(), bench.truth};
  const result::Rival turned{bench.loaded.model(), bench.turned(Vec3::UnitZ(), kPi / 4)};
  const result::Rival equal{bench.loaded.model(), bench.turned(Vec3::UnitZ(), kPi / 2)};
  CHECK(result::prevails(result::compare(truth, turned, bench.scene(), 1), 1.0));
  CHECK_FALSE(result::prevails(result::compare(turned, truth, bench.scene(), 1), 1.0));
  const auto tie = result::compare(truth, equal, bench.scene(), 1);
  CHECK(tie.same_object());
  CHECK_FALSE(result::prevails(tie, 1.0));
}

TEST_CASE("a pose prevails that explains clearly more than its rival, or all that the rival does") {
  CHECK(result::prevails({30000, 115, 7}, 1.0));
  CHECK(result::prevails({14000, 300, 60}, 1.0));
  // Two neighbours along a freedom that is hardly held: both wrong, the one by chance a little better.
  CHECK_FALSE(result::prevails({21000, 254, 39}, 1.0));
  CHECK_FALSE(result::prevails({95000, 207, 90}, 1.0));
}

TEST_CASE("a pose of a part that is half hidden needs more than a sliver to prevail") {
  for (const result::Rivalry& sliver : {result::Rivalry{13932, 117, 6}, {13512, 222, 13}, {9080, 178, 0}}) {
    CHECK_FALSE(result::prevails(sliver, 0.5));
    CHECK(result::prevails(sliver, 0.9));
  }
  CHECK(result::prevails({9080, 600, 40}, 0.3));
}
