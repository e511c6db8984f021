#include <catch2/catch.hpp>
#include <cstring>

#include "contract/result_codes.hpp"
#include "contract_io/mesh_io.hpp"
#include "support/one_line.hpp"
#include "support/shapes.hpp"
#include "support/temp_folder.hpp"
#include "teach/surface.hpp"
#include "teach/teach.hpp"

using namespace beltpick;

namespace {

// What reading these bytes under that name is refused with.
std::string refusal(const char* name, const std::string& bytes) {
  const test::TempFolder folder;
  const auto mesh = contract_io::read_mesh(folder.file(name, bytes), 1.0);
  REQUIRE_FALSE(mesh.has_value());
  CHECK(test::is_one_line(mesh.error()));
  return std::string(mesh.error().text());
}

Mesh read(const char* name, const std::string& bytes) {
  const test::TempFolder folder;
  const auto mesh = contract_io::read_mesh(folder.file(name, bytes), 1.0);
  INFO((mesh ? "" : mesh.error().detail));
  REQUIRE(mesh.has_value());
  return *mesh;
}

bool holds(const std::string& text, const char* words) { return text.find(words) != std::string::npos; }

Mesh scaled(Mesh mesh, float factor) {
  for (Vec3f& vertex : mesh.vertex_mm) vertex *= factor;
  return mesh;
}

double area_mm2(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& face : mesh.face) {
    const Vec3f a = mesh.vertex_mm[face[0]];
    sum += 0.5 * static_cast<double>((mesh.vertex_mm[face[1]] - a).cross(mesh.vertex_mm[face[2]] - a).norm());
  }
  return sum;
}

const std::string kFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\n";
const std::string kEll =  // an L of 3 squares as one polygon that begins at its inner corner
    "v 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\n";

}  // namespace

TEST_CASE("text STL in capitals is read; cut, with commas or polygons it is refused by name", "[teach][mesh]") {
  std::string capitals = "solid a\n" + kFacet + "endsolid\n";
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  CHECK(read("a.stl", capitals).face.size() == 1);
  CHECK(holds(refusal("b.stl", "solid a\n" + kFacet), "file is cut"));
  std::string commas = "solid a\n" + kFacet + "endsolid\n";
  commas.replace(commas.find("9 0 0"), 5, "9,5 0");
  CHECK(holds(refusal("c.stl", commas), "decimal points"));
  std::string square = "solid a\n" + kFacet + "endsolid\n";
  square.insert(square.find("endloop"), "vertex 9 9 0\n");
  CHECK(holds(refusal("d.stl", square), "found 4"));
  CHECK(holds(refusal("e.stl", "solid friends, a letter\n"), "holds no facets"));
  CHECK(holds(refusal("f.stl", ""), "empty file"));
  CHECK(holds(refusal("g.step", "ISO-10303-21;"), "CAD model"));
}

TEST_CASE("polygons that are not convex are cut into triangles that cover them", "[teach][mesh]") {
  const Mesh obj = read("a.obj", kEll + "f 1 2 3 4 5 6\n");
  CHECK(obj.face.size() == 4);
  CHECK(area_mm2(obj) == Approx(3));
  const Mesh from_end = read("a.obj", kEll + "f -6 -5 -4 -3 -2 -1\n");
  CHECK(from_end.face == obj.face);
  for (const auto& face : obj.face) {
    const Vec3f a = obj.vertex_mm[face[0]];
    CHECK((obj.vertex_mm[face[1]] - a).cross(obj.vertex_mm[face[2]] - a).z() > 0);
  }
}

TEST_CASE("a PLY of big-endian doubles, short indices and polygons is read", "[teach][mesh]") {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\ncomment from afar\nelement vertex 5\nproperty double x\nproperty double y\n"
      "property double z\nproperty uchar red\nelement face 1\nproperty uchar flag\nproperty list uchar ushort "
      "vertex_index\nend_header\n";
  const auto append = [&](auto value) {
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    bytes.append(raw.rbegin(), raw.rend());
  };
  // A square with a notch to its middle.
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {2.0, 2.0}, {0.0, 4.0}}) {
    append(x);
    append(y);
    append(1.5);
    bytes += '\xff';
  }
  bytes += '\x01';
  bytes += '\x05';
  for (std::uint16_t index = 0; index < 5; ++index) append(index);
  const Mesh mesh = read("a.ply", bytes);
  CHECK(mesh.face.size() == 3);
  CHECK(area_mm2(mesh) == Approx(12));
  CHECK(mesh.vertex_mm[2] == Vec3f(4, 4, 1.5F));
}

TEST_CASE("a PLY whose surface is told by strips does not pass for a scan", "[teach][mesh]") {
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  CHECK(holds(
      refusal("a.ply", vertices + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 "
                                  "0\n0 1 0\n3 0 1 2\n"),
      "tristrips"));
  CHECK(holds(
      refusal("b.ply", vertices + "element face 1\nproperty list uchar int corners\nend_header\n0 0 0\n1 0 0\n0 1 "
                                  "0\n3 0 1 2\n"),
      "vertex_indices"));
}

TEST_CASE("a part in the wrong unit is told with the right one", "[teach][mesh]") {
  const auto metres = teach::teach(scaled(test::bracket(), 0.001F), {}, {.points = 500});
  REQUIRE_FALSE(metres.has_value());
  CHECK(test::mentions(metres.error(), "--units m'"));
  const auto microns = teach::teach(scaled(test::bracket(), 1000.0F), {}, {.points = 500});
  REQUIRE_FALSE(microns.has_value());
  CHECK(test::mentions(microns.error(), "--units um'"));
  const auto inches = teach::teach(scaled(test::bracket(), 1 / 25.4F), {}, {.points = 500});
  REQUIRE(inches.has_value());
  REQUIRE_FALSE(inches->warnings.empty());
  CHECK(holds(inches->warnings.front(), "--units inch"));
  const auto right = teach::teach(test::bracket(), {}, {.points = 500});
  REQUIRE(right.has_value());
  for (const std::string& warning : right->warnings) CHECK_FALSE(holds(warning, "--units"));
  Mesh far = test::bracket();
  for (Vec3f& vertex : far.vertex_mm) vertex.x() += 50000;
  const auto refused = teach::teach(far, {}, {.points = 500});
  REQUIRE_FALSE(refused.has_value());
  CHECK(test::mentions(refused.error(), "origin"));
}

TEST_CASE("holes are told by their area, seams without area are none", "[teach][mesh]") {
  Mesh open = test::box(40, 40, 40);
  open.face.pop_back();
  const auto holed = teach::repair(open);
  CHECK(holed.holes == 1);
  CHECK(holed.open_edges == 3);
  CHECK(holed.hole_share == Approx(1.0 / 11.0));
  // Every face with corners of its own, rounded differently.
  Mesh loose;
  const Mesh box = test::box(40, 40, 40);
  for (const auto& face : box.face) {
    std::array<std::uint32_t, 3> own{};
    for (std::size_t k = 0; k < 3; ++k) {
      own[k] = static_cast<std::uint32_t>(loose.vertex_mm.size());
      const float rounding = 2e-5F * static_cast<float>(loose.vertex_mm.size() % 3);
      loose.vertex_mm.push_back(box.vertex_mm[face[k]] + Vec3f::Constant(rounding));
    }
    loose.face.push_back(own);
  }
  const auto welded = teach::repair(loose);
  CHECK(welded.open_edges == 0);
  CHECK(welded.flipped_faces == 0);
}

TEST_CASE("a crumb beside the part is left out, two bodies are told", "[teach][mesh]") {
  const auto with = [](float size, const Vec3f& at) {
    Mesh mesh = test::bracket();
    const Mesh box = test::box(size, size, size);
    const auto first = static_cast<std::uint32_t>(mesh.vertex_mm.size());
    for (const Vec3f& vertex : box.vertex_mm) mesh.vertex_mm.push_back(vertex + at);
    for (const auto& face : box.face) mesh.face.push_back({face[0] + first, face[1] + first, face[2] + first});
    return mesh;
  };
  Mesh crumb = with(0.5F, {900, 0, 0});
  const auto cleaned = teach::repair(crumb);
  CHECK(cleaned.specks == 1);
  CHECK(cleaned.pieces == 1);
  CHECK(crumb.face.size() == test::bracket().face.size());
  Mesh pair = with(40, {300, 0, 0});
  CHECK(teach::repair(pair).pieces == 2);
  Mesh touching = with(40, {80, 0, 0});
  CHECK(teach::repair(touching).pieces == 1);
}
