#include "virtual_cell/render/target_shapes.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace beltpick::virtual_cell {
namespace {

constexpr int kRefinements = 6;

using Face = std::array<std::uint32_t, 3>;

struct UnitBall {
  std::vector<Vec3> vertex;
  std::vector<Face> face;
};

UnitBall icosahedron() {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  UnitBall ball;
  for (const Vec3& v :
       {Vec3(-1, g, 0), Vec3(1, g, 0), Vec3(-1, -g, 0), Vec3(1, -g, 0), Vec3(0, -1, g), Vec3(0, 1, g), Vec3(0, -1, -g),
        Vec3(0, 1, -g), Vec3(g, 0, -1), Vec3(g, 0, 1), Vec3(-g, 0, -1), Vec3(-g, 0, 1)}) {
    ball.vertex.push_back(v.normalized());
  }
  ball.face = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
               {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
               {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return ball;
}

// Each face becomes four, their new corners on the sphere.
void refine(UnitBall& ball) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(ball.vertex.size()));
    if (fresh) ball.vertex.push_back((ball.vertex[a] + ball.vertex[b]).normalized());
    return at->second;
  };
  std::vector<Face> finer;
  for (const auto& [a, b, c] : ball.face) {
    const std::uint32_t ab = middle(a, b);
    const std::uint32_t bc = middle(b, c);
    const std::uint32_t ca = middle(c, a);
    for (const Face& face : {Face{a, ab, ca}, Face{b, bc, ab}, Face{c, ca, bc}, Face{ab, bc, ca}}) {
      finer.push_back(face);
    }
  }
  ball.face = std::move(finer);
}

Result<ScenePart> painted(Result<ScenePart> part) {
  if (part) part->finish = Finish::kMattWhite;
  return part;
}

}  // namespace

Result<ScenePart> make_ball(std::string name, double radius_mm) {
  UnitBall ball = icosahedron();
  for (int i = 0; i < kRefinements; ++i) refine(ball);
  // Facets lie within the sphere of their corners: the corners go out by the facets' mean depth.
  double depth = 0.0;
  for (const Face& face : ball.face) {
    const Vec3 centre = (ball.vertex[face[0]] + ball.vertex[face[1]] + ball.vertex[face[2]]) / 3.0;
    // Over a flat triangle the depth below the sphere is half of its middle's, in the mean.
    depth += 0.5 * (1.0 - centre.norm()) / static_cast<double>(ball.face.size());
  }
  Mesh mesh;
  for (const Vec3& vertex : ball.vertex) mesh.vertex_mm.push_back((radius_mm * (1.0 + depth) * vertex).cast<float>());
  mesh.face = std::move(ball.face);
  return painted(make_part(std::move(name), std::move(mesh)));
}

Result<ScenePart> make_block(std::string name, const Vec3& size_mm) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1) - 0.5, ((i >> 1) & 1) - 0.5, i >> 2);
    mesh.vertex_mm.push_back(corner.cwiseProduct(size_mm).cast<float>());
  }
  mesh.face = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
               {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return painted(make_part(std::move(name), std::move(mesh)));
}

}  // namespace beltpick::virtual_cell
