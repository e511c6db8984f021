// Parts on a belt to verified poses: right, or withheld with the reason; the same bits for any number of workers.
#include <catch2/catch.hpp>
#include <cstring>

#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/locate.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

void check_close(const LocatedPart& part, const result::PartPose& truth, const PartModel& model) {
  const PoseDifference d = difference_modulo_symmetry(part.T_camera_part, truth, model);
  CHECK(d.translation_mm < 0.6);
  CHECK(deg_from_rad(d.rotation_rad) < 0.35);
}

using Locator = InArena<pipeline::Locator>;

}  // namespace

TEST_CASE("single parts are found where they lie") {
  Locator locator(test_limits(), 1);
  for (const auto& shape : {bracket(), knuckle(), pin(), sheet()}) {
    const LoadedPart loaded(shape);
    for (const std::uint64_t seed : {1, 2, 3}) {
      const auto truth = on_belt(shape, loaded.part, any_rotation(seed), 20.0, 10.0);
      SceneImage image = render({{&shape, truth}}, {.seed = seed});
      const auto found = locator.made.locate(input_of(image), loaded.store.made.models());
      INFO(shape.name << " " << seed);
      REQUIRE(found.parts.size() == 1);
      CHECK(found.withheld.empty());
      check_close(found.parts[0], truth, loaded.model());
      CHECK((found.parts[0].status == PoseStatus::kAmbiguous) == loaded.model().symmetric());
    }
  }
}

TEST_CASE("a turn that cannot be seen is not told") {
  // Standing on its rim, the flange hides whether its holes are turned.
  const Shape shape = flange();
  const LoadedPart loaded(shape);
  Locator locator(test_limits(), 1);
  SceneImage image = render({{&shape, on_belt(shape, loaded.part, any_rotation(4), 20.0, 10.0)}});
  const auto found = locator.made.locate(input_of(image), loaded.store.made.models());
  CHECK(found.parts.empty());
  REQUIRE(found.withheld.size() == 1);
  CHECK(found.withheld[0].reason.code == ResultCode::kPoseAmbiguous);
}

TEST_CASE("foreign objects are withheld with a reason") {
  const LoadedPart loaded(bracket());
  Locator locator(test_limits(), 1);
  for (const auto& shape : {mirrored(bracket()), plate(), pin()}) {
    const PartTemplate part = template_of(shape, 3000);
    SceneImage image = render({{&shape, on_belt(shape, part, Mat3::Identity(), 0.0, 0.0)}});
    const auto found = locator.made.locate(input_of(image), loaded.store.made.models());
    INFO(shape.name);
    CHECK(found.parts.empty());
    REQUIRE(found.withheld.size() == 1);
    CHECK(found.withheld[0].reason.code != ResultCode::kOk);
    CHECK(std::strlen(found.withheld[0].reason.detail) > 10);
  }
}

TEST_CASE(
    "a mirror twin that lies on something, so that the belt does not tell which way up, is not taken for the part") {
  Shape shape = sheet();
  for (const double side : {1.0, -1.0}) {
    Primitive face;
    face.direction = side * Vec3::UnitZ();
    face.point_mm = 1.5 * face.direction;
    shape.primitives.push_back(face);
  }
  const LoadedPart loaded(shape);
  Locator locator(test_limits(), 1);
  // The twin with its flange up is, but for the flange, the part with its flange down.
  for (const auto& lying : {mirrored(shape), shape}) {
    auto pose = on_belt(lying, template_of(lying, 3000), Mat3::Identity(), 0.0, 0.0);
    pose.translation_mm -= 35.0 * pose.translation_mm.normalized();
    SceneImage image = render({{&lying, pose}});
    const auto found = locator.made.locate(input_of(image), loaded.store.made.models());
    INFO(lying.name);
    CHECK(found.parts.size() == (lying.name == shape.name ? 1 : 0));
    if (found.parts.empty()) CHECK(found.withheld[0].reason.code == ResultCode::kPoseAmbiguous);
  }
}

TEST_CASE("objects that were not parted, and parts in pieces, are found all the same") {
  const Shape first = bracket(), second = knuckle();
  const LoadedPart one(first), two(second);
  const auto truth_one = on_belt(first, one.part, Mat3::Identity(), -60.0, 0.0);
  const auto truth_two = on_belt(second, two.part, any_rotation(2), 60.0, 20.0);
  SceneImage image = render({{&first, truth_one}, {&second, truth_two}});
  InArena<pipeline::ModelStore> store(test_limits());
  const std::vector<PartTemplate> parts{one.part, two.part};
  REQUIRE(store.made.load(parts));
  Locator locator(test_limits(), 1);
  SECTION("merged") { image.merge(2, 1); }
  SECTION("in pieces") {
    // A stripe of nothing through the second part.
    const Segment s = image.segments[1];
    for (int row = s.row_min; row <= s.row_max; ++row) {
      for (int col = (s.col_min + s.col_max) / 2; col < s.col_max; ++col) {
        if (image.labels()(row, col) == 2) image.labels()(row, col) = col < (s.col_min + s.col_max) / 2 + 3 ? 0 : 3;
      }
    }
    image.recount();
  }
  const auto found = locator.made.locate(input_of(image), store.made.models());
  REQUIRE(found.parts.size() == 2);
  for (const LocatedPart& part : found.parts) {
    if (part.template_index == 0) check_close(part, truth_one, store.made.models()[0]);
    if (part.template_index == 1) check_close(part, truth_two, store.made.models()[1]);
  }
  CHECK(found.parts[0].template_index != found.parts[1].template_index);
}

TEST_CASE("a part that stands on one face is found by the other, once it lies inside the image") {
  Shape shape = knuckle();
  for (const double side : {1.0, -1.0}) {
    Primitive face;
    face.direction = side * Vec3::UnitY();
    face.point_mm = 35.0 * face.direction;
    shape.primitives.push_back(face);
  }
  const LoadedPart loaded(shape);
  Locator locator(test_limits(), 1);
  for (const double turn_deg : {-30.0, -20.0, 10.0}) {
    const Mat3 standing =
        (Eigen::AngleAxisd(rad_from_deg(turn_deg), Vec3::UnitZ()) * Eigen::AngleAxisd(kPi / 2, Vec3::UnitX()))
            .toRotationMatrix();
    const auto located_at = [&](double x_mm, const auto& check) {
      const auto truth = on_belt(shape, loaded.part, standing, x_mm, 20.0);
      SceneImage image = render({{&shape, truth}});
      auto input = input_of(image);
      input.projector_mm = scene_light_mm();
      check(locator.made.locate(input, loaded.store.made.models()), truth);
    };
    INFO(turn_deg);
    // Two fifths of it lie beyond the edge: all that is seen is one face, which another part may have, too.
    located_at(165.0, [](const pipeline::LocateOutput& found, const auto&) {
      CHECK(found.parts.empty());
      REQUIRE(found.withheld.size() == 1);
      CHECK(found.withheld[0].reason.code == ResultCode::kPartlyOutOfView);
    });
    located_at(110.0, [&](const pipeline::LocateOutput& found, const auto& truth) {
      REQUIRE(found.parts.size() == 1);
      const PoseDifference d = difference_modulo_symmetry(found.parts[0].T_camera_part, truth, loaded.model());
      CHECK(d.translation_mm < 1.0);
      CHECK(deg_from_rad(d.rotation_rad) < 1.0);
    });
  }
}

TEST_CASE("a part that shows little more than its hub is right or withheld") {
  const Shape shape = knuckle();
  const LoadedPart loaded(shape);
  Locator locator(test_limits(), 1);
  // The hub's axis along the image border, the arm beyond it.
  for (const double x_mm : {170.0, 180.0, 190.0}) {
    for (const double turn_deg : {-40.0, -15.0, 15.0, 40.0}) {
      const Mat3 rotation = Eigen::AngleAxisd(rad_from_deg(turn_deg), Vec3::UnitY()).toRotationMatrix();
      const auto truth = on_belt(shape, loaded.part, rotation, x_mm, 10.0);
      SceneImage image = render({{&shape, truth}});
      auto input = input_of(image);
      input.projector_mm = scene_light_mm();
      for (const LocatedPart& part : locator.made.locate(input, loaded.store.made.models()).parts) {
        INFO(x_mm << " " << turn_deg);
        const PoseDifference d = difference_modulo_symmetry(part.T_camera_part, truth, loaded.model());
        CHECK(d.translation_mm < 1.0);
        CHECK(deg_from_rad(d.rotation_rad) < 1.0);
      }
    }
  }
}

TEST_CASE("any number of workers gives the same bits, and so does doing it again") {
  const Shape shape = bracket();
  const LoadedPart loaded(shape);
  SceneImage image = render({{&shape, on_belt(shape, loaded.part, any_rotation(1), -90.0, 0.0)},
                             {&shape, on_belt(shape, loaded.part, any_rotation(2), 90.0, 40.0)},
                             {&shape, on_belt(shape, loaded.part, any_rotation(3), 20.0, -70.0)}});
  std::vector<std::vector<LocatedPart>> runs;
  for (const int workers : {1, 2, 3, 1}) {
    Locator locator(test_limits(), workers);
    const auto found = locator.made.locate(input_of(image), loaded.store.made.models());
    runs.emplace_back(found.parts.begin(), found.parts.end());
  }
  REQUIRE(runs[0].size() == 3);
  for (const auto& run : runs) {
    REQUIRE(run.size() == runs[0].size());
    for (std::size_t i = 0; i < run.size(); ++i) {
      CHECK(run[i].T_camera_part.matrix() == runs[0][i].T_camera_part.matrix());
      CHECK(run[i].covariance == runs[0][i].covariance);
      CHECK(run[i].score == runs[0][i].score);
    }
  }
}

TEST_CASE("templates beyond the limits are refused by name") {
  Limits limits = test_limits();
  limits.template_points = 500;
  InArena<pipeline::ModelStore> store(limits);
  const PartTemplate part = template_of(block(), 2000);
  const auto large = store.made.load({&part, 1});
  REQUIRE_FALSE(large);
  CHECK(large.error().code == ResultCode::kTemplateTooLarge);
  const std::vector<PartTemplate> many(3);
  const auto crowd = store.made.load(many);
  REQUIRE_FALSE(crowd);
  CHECK(crowd.error().code == ResultCode::kLimitExceeded);
  const auto none = store.made.load({});
  REQUIRE_FALSE(none);
  CHECK(none.error().code == ResultCode::kNoTemplate);
}
