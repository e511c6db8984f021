// A part, its mirror image and its near twin: what teaching says of them, and what locating makes of them.
#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "contract_io/mesh_io.hpp"
#include "support/json_file.hpp"
#include "support/run_program.hpp"
#include "support/shapes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

void must(const std::string& arguments) {
  const Outcome outcome = beltpick_run(arguments);
  INFO(arguments << ": " << outcome.err);
  REQUIRE(outcome.exit_code == 0);
}

Mesh mirrored(Mesh mesh) {
  for (Vec3f& vertex : mesh.vertex_mm) vertex.x() = -vertex.x();
  for (auto& face : mesh.face) std::swap(face[1], face[2]);
  return mesh;
}

// bracket.stl and .template, and those of its mirror image.
const TempFolder& twins() {
  static const TempFolder folder;
  static const bool made = [] {
    must("simulate --write-parts " + folder.path().string() + " --part bracket");
    const auto mesh = contract_io::read_mesh(folder / "bracket.stl", 1.0);
    REQUIRE(contract_io::write_stl(folder / "mirror.stl", mirrored(*mesh)).has_value());
    for (const char* name : {"bracket", "mirror"}) {
      const std::string path = (folder / name).string();
      must("teach " + path + ".stl --out " + path + ".template");
    }
    return true;
  }();
  (void)made;
  return folder;
}

}  // namespace

TEST_CASE("teaching tells the mirror image and the same part from strangers", "[twins]") {
  const auto compared = [](const std::string& part, const std::string& against) {
    const Outcome outcome = beltpick_run("teach " + (twins() / (part + ".stl")).string() + " --json --out " +
                                         (twins() / "again.template").string() + " --against " +
                                         (twins() / (against + ".template")).string());
    REQUIRE(outcome.exit_code == 0);
    return nlohmann::json::parse(outcome.out)["against"][0];
  };
  const auto mirror = compared("bracket", "mirror");
  CHECK(mirror["kinship"] == "mirror_twins");
  CHECK(mirror["differing_share"] > 0.02);
  const auto same = compared("bracket", "bracket");
  CHECK(same["kinship"] == "same");
  CHECK(same["largest_mm"] < 1.0);
}

TEST_CASE("a near twin is described by what it has more, and where", "[twins]") {
  Mesh plain;
  add_box(plain, {0, 0, 0}, {90, 50, 8});
  add_box(plain, {0, 0, 8}, {8, 50, 45});
  add_cylinder(plain, {62, 20, 8}, 12, 22);
  Mesh more = plain;
  add_cylinder(more, {30, 38, 8}, 5, 9);
  REQUIRE(contract_io::write_stl(twins() / "plain.stl", plain).has_value());
  REQUIRE(contract_io::write_stl(twins() / "more.stl", more).has_value());
  must("teach " + (twins() / "plain.stl").string() + " --out " + (twins() / "plain.template").string());
  const Outcome outcome =
      beltpick_run("teach " + (twins() / "more.stl").string() + " --json --out " +
                   (twins() / "more.template").string() + " --against " + (twins() / "plain.template").string());
  REQUIRE(outcome.exit_code == 0);
  const auto found = nlohmann::json::parse(outcome.out)["against"][0];
  CHECK(found["kinship"] == "near_twins");
  CHECK(found["differing_share"] < 0.05);
  CHECK(found["largest_mm"] == Approx(9.0).margin(1.5));
  const Vec3 where(found["where_mm"][0], found["where_mm"][1], found["where_mm"][2]);
  CHECK((where - Vec3(30, 38, 17)).norm() < 8.0);
  // From below nobody sees the boss.
  CHECK(found["blind_share"] > 0.1);
  CHECK(found["blind_share"] < 0.9);
  CHECK(outcome.err.find("POSE_AMBIGUOUS") != std::string::npos);
}

TEST_CASE("with a part and its mirror image loaded nothing gets the other's name", "[twins]") {
  int right = 0;
  for (const char* name : {"bracket", "mirror"}) {
    const auto scene = twins() / (std::string("scene_") + name);
    must("simulate --out " + scene.string() + " --scene belt --parts 3 --lay any,any,any --seed 77 --part " +
         (twins() / (std::string(name) + ".stl")).string());
    const auto result = twins() / "result.json";
    must("locate " + scene.string() + " --calibration " + (scene / "calibration.json").string() + " --template " +
         (twins() / "bracket.template").string() + " " + (twins() / "mirror.template").string() + " --out " +
         result.string());
    const auto located = json_of(result);
    for (const auto& part : located["parts"]) {
      CHECK(part["part"] == name);
      ++right;
    }
  }
  CHECK(right >= 4);
}
