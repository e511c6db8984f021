// Parts and scenes: closed meshes, stable rest, nothing inside anything else.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "virtual_cell/render/contact_field.hpp"
#include "virtual_cell/render/part_shapes.hpp"
#include "virtual_cell/render/scene.hpp"
#include "virtual_cell/render/settle.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

const ScenePart& knuckle() {
  static const ScenePart part = builtin_part("knuckle").value();
  return part;
}

const SceneMaker& maker() {
  static const Rig rig = make_rig().value();
  static const SceneMaker made({&knuckle(), 1}, rig);
  return made;
}

// Signed distance of a point to a mesh by looking at all triangles: the angle-weighted solid angle tells the side.
double slow_distance(const Mesh& mesh, const Vec3& p) {
  double nearest = 1e9;
  double solid_angle = 0.0;
  for (const auto& face : mesh.face) {
    const Vec3 a = mesh.vertex_mm[face[0]].cast<double>() - p;
    const Vec3 b = mesh.vertex_mm[face[1]].cast<double>() - p;
    const Vec3 c = mesh.vertex_mm[face[2]].cast<double>() - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    // Points on the triangle, finely enough for triangles of a millimetre.
    constexpr int kSteps = 6;
    if (std::min({la, lb, lc}) > nearest + 4.0) continue;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        nearest = std::min(nearest, (a + (b - a) * i / kSteps + (c - a) * j / kSteps).norm());
      }
    }
  }
  return solid_angle > 6.28 ? -nearest : nearest;
}

// Deepest vertex of one part inside another, by the slow distance on the vertices that come near.
double slow_penetration(const BeltPart& one, const BeltPart& other) {
  const Pose<frame::Part, frame::Belt> T_part_belt = other.T_belt_part.inverse();
  static const ContactField coarse(knuckle());  // only to choose the vertices worth the slow look
  double deepest = 0.0;
  for (const Vec3f& vertex : knuckle().mesh.vertex_mm) {
    const Vec3 local = T_part_belt * (one.T_belt_part * vertex.cast<double>());
    if (coarse.distance(local) > 0.3) continue;
    deepest = std::max(deepest, -slow_distance(knuckle().mesh, local));
  }
  return deepest;
}

double lowest(const BeltPart& placed) {
  double z = 1e9;
  for (const Vec3f& v : knuckle().mesh.vertex_mm) z = std::min(z, (placed.T_belt_part * v.cast<double>()).z());
  return z;
}

}  // namespace

TEST_CASE("built-in parts are closed, oriented outwards and within the size of the paper's part") {
  for (const std::string& name : builtin_part_names()) {
    const ScenePart part = builtin_part(name).value();
    CHECK(part.mesh.face.size() < 100000);
    CHECK(part.volume_mm3 > 1e4);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& face : part.mesh.face) {
      for (int i = 0; i < 3; ++i) {
        ++edges[{face[i], face[(i + 1) % 3]}];
      }
    }
    int open = 0;
    for (const auto& [edge, count] : edges) {
      const auto back = edges.find({edge.second, edge.first});
      open += back == edges.end() || back->second != count ? 1 : 0;
    }
    CHECK(open == 0);
  }
  Eigen::AlignedBox3d box;
  for (const Vec3f& v : knuckle().mesh.vertex_mm) box.extend(v.cast<double>());
  CHECK(box.sizes().x() == Approx(170.0).margin(6.0));
  CHECK(box.sizes().y() == Approx(100.0).margin(6.0));
  CHECK(box.sizes().z() == Approx(58.0).margin(4.0));
}

TEST_CASE("the knuckle's boss is a true cylinder") {
  int on_boss = 0;
  for (const Vec3f& v : knuckle().mesh.vertex_mm) {
    if (v.x() > -45.0F || std::abs(v.y()) > 34.0F || v.z() < 12.0F) continue;  // clear of arm and rim
    if (std::hypot(v.x() + 40.0F, v.z()) < 0.5 * (kKnuckleBossRadiusMm + kKnuckleBoreRadiusMm)) continue;
    CHECK(std::hypot(v.x() + 40.0F, v.z()) == Approx(kKnuckleBossRadiusMm).margin(0.01));
    ++on_boss;
  }
  CHECK(on_boss > 200);
}

TEST_CASE("a mesh that is open, inside out or of another unit is refused in one line") {
  Mesh inside_out = knuckle().mesh;
  for (auto& face : inside_out.face) std::swap(face[0], face[1]);
  CHECK(make_part("knuckle", inside_out).error().text().find("wound outwards") != std::string_view::npos);
  Mesh in_metres = knuckle().mesh;
  for (Vec3f& v : in_metres.vertex_mm) v *= 0.001F;
  CHECK(make_part("knuckle", in_metres).error().text().find("unit") != std::string_view::npos);
  CHECK(!make_part("nothing", Mesh{}));
}

TEST_CASE("the elbow's symmetry maps it onto itself") {
  const ScenePart elbow = builtin_part("elbow").value();
  REQUIRE(elbow.symmetries.size() == 1);
  double worst = 0.0;
  for (const Vec3f& v : elbow.mesh.vertex_mm) {
    worst = std::max(worst, std::abs(elbow_distance(elbow.symmetries[0] * v.cast<double>())));
  }
  CHECK(worst < 0.05);
}

TEST_CASE("the contact field is the distance to the mesh") {
  const ContactField field(knuckle());
  double worst = 0.0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 p(-62.0 + 4.1 * i, -20.0 + 1.3 * i, -12.0 + 0.8 * i);
    const double expected = std::clamp(slow_distance(knuckle().mesh, p), -field.band_mm(), field.band_mm());
    worst = std::max(worst, std::abs(field.distance(p) - expected));
  }
  CHECK(worst < 0.3);
}

TEST_CASE("a part left in a resting pose stays there") {
  const std::vector<RestingPose>& poses = maker().resting(0);
  REQUIRE(poses.size() >= 3);
  double total = 0.0;
  const Settler settler({&knuckle(), 1});
  for (const RestingPose& pose : poses) {
    total += pose.weight;
    if (pose.weight < 0.03) continue;
    BeltPart placed;
    placed.T_belt_part.rotation = pose.R_belt_part;
    placed.T_belt_part.translation_mm.z() = pose.height_mm - (pose.R_belt_part * knuckle().centre_of_mass_mm).z();
    CHECK(lowest(placed) == Approx(0.0).margin(0.05));
    Scene scene{placed};
    REQUIRE(settler.settle(scene));
    CHECK(rotation_between_rad(scene[0].T_belt_part.rotation, pose.R_belt_part) < 0.02);
  }
  CHECK(total == Approx(1.0));
}

TEST_CASE("leaning parts touch, rest on the belt and do not interpenetrate") {
  int leaning = 0;
  const std::vector<Lay> lays{Lay::kFlat, Lay::kLeaning};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = maker().make(lays, seed);
    REQUIRE(scene.size() == 2);
    for (const BeltPart& placed : scene) CHECK(lowest(placed) > -0.2);
    CHECK(slow_penetration(scene[0], scene[1]) < 0.2);
    CHECK(slow_penetration(scene[1], scene[0]) < 0.2);
    const Settler settler({&knuckle(), 1});
    if (!settler.touch(scene, 1)) continue;
    ++leaning;
    Scene later = scene;
    REQUIRE(settler.settle(later));
    CHECK((later[1].T_belt_part.translation_mm - scene[1].T_belt_part.translation_mm).norm() < 1.0);
  }
  CHECK(leaning >= 2);
}

TEST_CASE("belts have the parts asked for, the same by seed, and none in another") {
  const std::vector<Scene> belt = maker().make_belt(12, 4);
  const std::vector<Scene> again = maker().make_belt(12, 4);
  std::size_t parts = 0;
  REQUIRE(belt.size() == again.size());
  for (std::size_t v = 0; v < belt.size(); ++v) {
    parts += belt[v].size();
    REQUIRE(belt[v].size() == again[v].size());
    for (std::size_t i = 0; i < belt[v].size(); ++i) {
      CHECK(belt[v][i].T_belt_part.matrix() == again[v][i].T_belt_part.matrix());
      for (std::size_t j = 0; j < belt[v].size(); ++j) {
        if (i != j) CHECK(slow_penetration(belt[v][i], belt[v][j]) < 0.2);
      }
    }
  }
  CHECK(parts == 12);
}

TEST_CASE("the paper's twelve scenes have three parts each") {
  for (int number = 1; number <= 12; ++number) CHECK(maker().make_paper_scene(number, 1).value().size() == 3);
  CHECK(!maker().make_paper_scene(13, 1));
}
