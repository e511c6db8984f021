#include <zlib.h>

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/grasps_io.hpp"
#include "contract_io/mesh_io.hpp"
#include "contract_io/template_io.hpp"
#include "support/shapes.hpp"
#include "teach/teach.hpp"

using namespace beltpick;

namespace {

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("beltpick_teach_" + std::to_string(getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

}  // namespace

TEST_CASE("the boss and the large planes of a bracket are found", "[teach]") {
  const auto taught = teach::teach(test::bracket(), {}, {});
  REQUIRE(taught.has_value());
  CHECK(taught->part.point_mm.size() > 35000);
  const auto& primitives = taught->part.primitives;
  const auto boss = std::find_if(primitives.begin(), primitives.end(),
                                 [](const Primitive& p) { return p.kind == PrimitiveKind::kCylinder; });
  REQUIRE(boss != primitives.end());
  CHECK(boss->radius_mm == Approx(12).margin(0.1));
  CHECK(std::abs(boss->direction.z()) > 0.9995);
  CHECK((boss->point_mm.head<2>() - Eigen::Vector2d(62, 20)).norm() < 0.2);
  CHECK_FALSE(boss->concave);
  CHECK(std::count_if(primitives.begin(), primitives.end(),
                      [](const Primitive& p) { return p.kind == PrimitiveKind::kPlane; }) >= 3);
  CHECK(!taught->part.grasps.empty());
  CHECK(taught->part.box_max_mm.isApprox(Vec3(90, 50, 45), 0.02));
}

TEST_CASE("a template comes back from its file as it was", "[teach][template]") {
  const Folder folder;
  auto taught = teach::teach(test::bracket(), {}, {.points = 5000});
  taught->part.symmetry.elements.push_back({});
  taught->part.cones.push_back({{1, 2, 3}, Vec3::UnitX(), 0.5, 1, 2, true, 0.1});
  taught->part.steps = {0.3, 2.5};
  const auto path = folder.path / "angle.template";
  REQUIRE(contract_io::write_template(path, taught->part).has_value());
  const auto read = contract_io::read_template(path);
  REQUIRE(read.has_value());
  CHECK(read->name == "angle");
  CHECK(read->point_mm == taught->part.point_mm);
  CHECK(read->normal == taught->part.normal);
  CHECK(read->primitives.size() == taught->part.primitives.size());
  CHECK(read->primitives[0].direction == taught->part.primitives[0].direction);
  CHECK(read->grasps.size() == taught->part.grasps.size());
  CHECK(read->symmetry.elements.size() == 1);
  REQUIRE(read->cones.size() == 1);
  CHECK(read->cones[0].half_angle_rad == 0.5);
  REQUIRE(read->resting.size() == taught->part.resting.size());
  CHECK(read->resting[0].down == taught->part.resting[0].down);
  REQUIRE(read->routes.size() == taught->part.routes.size());
  CHECK(read->routes[0].poses == taught->part.routes[0].poses);
  CHECK(read->steps.shift_mm == 2.5);
}

TEST_CASE("a template without the members that came later is read, a later version is refused by name",
          "[teach][template]") {
  const Folder folder;
  const auto taught = teach::teach(test::bracket(), {}, {.points = 500});
  const auto path = folder.path / "part.template";
  REQUIRE(contract_io::write_template(path, taught->part).has_value());
  std::ifstream file(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  const std::size_t line_end = whole.find('\n');
  const std::size_t json_bytes = std::stoul(whole.substr(whole.rfind(' ', line_end)));
  auto json = nlohmann::json::parse(whole.substr(line_end + 1, json_bytes));
  for (const char* later : {"cones", "resting_positions", "routes", "search_steps"}) json.erase(later);
  json["of a later version"] = 1;
  const std::string rest = json.dump() + whole.substr(line_end + 1 + json_bytes);
  const auto sum = crc32_z(0, reinterpret_cast<const unsigned char*>(rest.data()), rest.size());
  char line[80];
  std::snprintf(line, sizeof line, "beltpick-template 1 %08lx %zu\n", sum, json.dump().size());
  const auto old = contract_io::parse_template(line + rest, "part", "part.template");
  INFO((old ? "" : old.error().detail));
  REQUIRE(old.has_value());
  CHECK(old->routes.empty());
  CHECK(old->steps.turn_rad == 0.0);
  CHECK(old->point_mm == taught->part.point_mm);
  const auto later = contract_io::parse_template("beltpick-template 2" + whole.substr(19), "part", "part.template");
  REQUIRE_FALSE(later.has_value());
  CHECK(later.error().code == ResultCode::kVersionUnsupported);
  CHECK(later.error().text().find("later beltpick") != std::string_view::npos);
}

TEST_CASE("a template torn or changed anywhere is refused", "[teach][template]") {
  const Folder folder;
  const auto taught = teach::teach(test::bracket(), {}, {.points = 500});
  const auto path = folder.path / "part.template";
  REQUIRE(contract_io::write_template(path, taught->part).has_value());
  std::ifstream file(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  const auto refused = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    return !contract_io::read_template(path).has_value();
  };
  for (std::size_t cut = 0; cut < whole.size(); cut += 97) CHECK(refused(whole.substr(0, cut)));
  for (std::size_t at = 0; at < whole.size(); at += 61) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x20);
    CHECK(refused(changed));
  }
}

TEST_CASE("meshes are read in every format, alike", "[teach][mesh]") {
  const Folder folder;
  const Mesh mesh = test::box(3, 2, 1);
  const auto stl = folder.path / "box.stl";
  REQUIRE(contract_io::write_stl(stl, mesh).has_value());
  const auto from_stl = contract_io::read_mesh(stl, 10.0);
  REQUIRE(from_stl.has_value());
  CHECK(from_stl->vertex_mm.size() == 8);
  CHECK(from_stl->face.size() == 12);
  std::ofstream ply(folder.path / "box.ply");
  ply << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
  ply.close();
  CHECK(contract_io::read_mesh(folder.path / "box.ply", 1.0)->face.size() == 2);
  std::ofstream obj(folder.path / "box.obj");
  obj << "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 -1//1\n";
  obj.close();
  CHECK(contract_io::read_mesh(folder.path / "box.obj", 1.0)->face.size() == 1);
  std::ofstream text(folder.path / "text.stl");
  text << "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
          "0\nendloop\nendfacet\nendsolid\n";
  text.close();
  CHECK(contract_io::read_mesh(folder.path / "text.stl", 1.0)->face.size() == 1);
}

TEST_CASE("what is no mesh is refused in one line", "[teach][mesh]") {
  const Folder folder;
  const auto refused = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder.path / name, std::ios::binary) << bytes;
    const auto mesh = contract_io::read_mesh(folder.path / name, 1.0);
    REQUIRE_FALSE(mesh.has_value());
    CHECK(mesh.error().text().find('\n') == std::string_view::npos);
    return mesh.error().code;
  };
  CHECK(refused("a.stl", "just a text") == ResultCode::kFormatInvalid);
  CHECK(refused("b.stl", "solid nothing\nendsolid\n") == ResultCode::kMeshInvalid);
  CHECK(refused("c.stl", std::string(84, '\0') + "cut") == ResultCode::kFormatInvalid);
  CHECK(refused("d.ply",
                "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float "
                "z\nend_header\n0 0\n") == ResultCode::kFormatInvalid);
  CHECK(refused("e.obj", "v 0 0 0\nf 1 2 3\n") == ResultCode::kFormatInvalid);
  CHECK(refused("f.step", "ISO-10303-21;") == ResultCode::kFormatInvalid);
  CHECK(refused("g.stl", "") == ResultCode::kFormatInvalid);
}

TEST_CASE("grasps are read in order, squared, and wrong ones named", "[teach][grasps]") {
  const Folder folder;
  const auto path = folder.path / "grasps.toml";
  std::ofstream(path)
      << "[[grasp]]\nname='boss'\nposition_mm=[1,2,3]\napproach=[0,0,-2]\nclosing=[1,0,0.2]\nopening_mm=40\n";
  const auto grasps = contract_io::read_grasps(path);
  REQUIRE(grasps.has_value());
  CHECK(grasps->front().T_part_gripper.rotation.col(2).isApprox(Vec3(0, 0, -1)));
  CHECK(grasps->front().T_part_gripper.rotation.col(0).isApprox(Vec3(1, 0, 0)));
  CHECK(grasps->front().T_part_gripper.rotation.determinant() == Approx(1));
  std::ofstream(path) << "[[grasp]]\nposition_mm=[1,2,3]\napproach=[0,0,-1]\nclosing=[0,0,1]\nopening_mm=40\n";
  CHECK(contract_io::read_grasps(path).error().code == ResultCode::kValueOutOfRange);
  std::ofstream(path) << "[[grasp]]\nposition_mm=[1,2]\napproach=[0,0,-1]\nclosing=[1,0,0]\n";
  CHECK(contract_io::read_grasps(path).error().code == ResultCode::kFormatInvalid);
}
