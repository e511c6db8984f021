// grasps.toml's gripper, and the template that carries it.
#include <catch2/catch.hpp>
#include <fstream>
#include <string>

#include "contract/result_codes.hpp"
#include "contract_io/grasps_io.hpp"
#include "contract_io/template_io.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

Result<std::optional<GripperShape>> gripper_of(const std::string& toml) {
  const TempFolder folder;
  std::ofstream(folder.path() / "grasps.toml") << toml;
  return contract_io::read_gripper(folder.path() / "grasps.toml");
}

PartTemplate one_point() {
  PartTemplate part;
  part.point_mm = {Vec3f(1, 2, 3)};
  part.normal = {Vec3f::UnitZ()};
  part.spacing_mm = 1.0;
  part.box_max_mm = {10, 10, 10};
  return part;
}

}  // namespace

TEST_CASE("a gripper is optional, and so is each of its sizes", "[grasps]") {
  const auto none = gripper_of("[[grasp]]\nname = 'boss'\n");
  REQUIRE(none);
  CHECK_FALSE(*none);
  const auto some = gripper_of("[gripper]\njaw_width_mm = 30\npalm_length_mm = 0\n");
  REQUIRE(some);
  REQUIRE(*some);
  CHECK((*some)->jaw_width_mm == 30.0);
  CHECK((*some)->palm_length_mm == 0.0);
  CHECK((*some)->jaw_depth_mm == GripperShape{}.jaw_depth_mm);
}

TEST_CASE("a gripper that cannot be is refused by the member's name", "[grasps]") {
  const auto unknown = gripper_of("[gripper]\njaw_lenght_mm = 30\n");
  REQUIRE_FALSE(unknown);
  CHECK(std::string(unknown.error().detail).find("jaw_lenght_mm") != std::string::npos);
  const auto words = gripper_of("[gripper]\njaw_width_mm = 'wide'\n");
  REQUIRE_FALSE(words);
  CHECK(words.error().code == ResultCode::kFormatInvalid);
  for (const char* wrong : {"jaw_width_mm = -1", "jaw_thickness_mm = 0", "jaw_depth_mm = 2", "reach_mm = nan"}) {
    const auto refused = gripper_of(std::string("[gripper]\n") + wrong + "\n");
    INFO(wrong);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ResultCode::kValueOutOfRange);
  }
}

TEST_CASE("a template keeps its gripper; one without stays without", "[grasps]") {
  const TempFolder folder;
  PartTemplate part = one_point();
  REQUIRE(contract_io::write_template(folder.path() / "a.template", part));
  CHECK_FALSE(contract_io::read_template(folder.path() / "a.template")->gripper);
  part.gripper = GripperShape{.jaw_thickness_mm = 5.5, .jaw_depth_mm = 42.0, .palm_width_mm = 33.0};
  REQUIRE(contract_io::write_template(folder.path() / "b.template", part));
  const auto read = contract_io::read_template(folder.path() / "b.template");
  REQUIRE(read);
  REQUIRE(read->gripper);
  CHECK(*read->gripper == *part.gripper);
}
