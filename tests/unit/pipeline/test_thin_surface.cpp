// What the template's points are put in order and thinned by, against what every pair of them tells.
#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "base/random.hpp"
#include "pipeline/spatial_order.hpp"
#include "pipeline/thin_surface.hpp"

using namespace beltpick;

namespace {

// Both sides of a sheet half a millimetre thick, points at random.
std::vector<OrientedPoint> sheet(int count) {
  Random random(5);
  std::vector<OrientedPoint> points;
  for (int i = 0; i < count; ++i) {
    const float side = i % 2 == 0 ? 1.0F : -1.0F;
    const auto mm = [&](double extent) { return static_cast<float>(random.uniform() * extent); };
    points.push_back({Vec3f(mm(60.0), mm(40.0), 0.25F * side), Vec3f(0.0F, 0.0F, side)});
  }
  return points;
}

std::vector<OrientedPoint> read(std::span<const PointBlock> blocks, std::size_t count) {
  std::vector<OrientedPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const PointBlock& b = blocks[i / PointBlock::kSize];
    const std::size_t k = i % PointBlock::kSize;
    points.push_back({Vec3f(b.x[k], b.y[k], b.z[k]), Vec3f(b.nx[k], b.ny[k], b.nz[k])});
  }
  return points;
}

// From a point to the nearest of others on its side of the sheet.
float nearest_mm(const OrientedPoint& point, const std::vector<OrientedPoint>& others) {
  float least = 1e9F;
  for (const OrientedPoint& other : others) {
    const float apart = (other.point_mm - point.point_mm).norm();
    if (apart > 0.0F && other.normal.dot(point.normal) > 0.5F) least = std::min(least, apart);
  }
  return least;
}

}  // namespace

TEST_CASE("thinned points lie apart, and near every point left out, on both sides of a sheet", "[thin_surface]") {
  const auto all = sheet(4000);
  std::vector<PointBlock> blocks(PointBlock::blocks_for(all.size()));
  constexpr float kApart_mm = 2.0F;
  const auto kept = read(blocks, pipeline::thin_surface(all, kApart_mm, blocks));
  CHECK(kept.size() > 500);
  CHECK(kept.size() < 900);
  CHECK(std::all_of(kept.begin(), kept.end(), [&](const auto& p) { return nearest_mm(p, kept) >= kApart_mm; }));
  const auto covered = [&](const OrientedPoint& p) {
    const auto same = [&](const OrientedPoint& k) { return k.point_mm == p.point_mm; };
    return nearest_mm(p, kept) < kApart_mm || std::any_of(kept.begin(), kept.end(), same);
  };
  CHECK(std::all_of(all.begin(), all.end(), covered));
}

TEST_CASE("what does not fit is left out of thinned points", "[thin_surface]") {
  std::vector<PointBlock> blocks(1);
  CHECK(pipeline::thin_surface(sheet(500), 0.1F, blocks) == PointBlock::kSize);
}

TEST_CASE("points in spatial order are all there, and neighbours follow one another", "[spatial_order]") {
  std::vector<Vec3f> points;
  for (const OrientedPoint& p : sheet(4000)) points.push_back(p.point_mm);
  auto order = pipeline::spatial_order(points);
  double in_order_mm = 0.0, as_given_mm = 0.0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    in_order_mm += static_cast<double>((points[order[i]] - points[order[i - 1]]).norm());
    as_given_mm += static_cast<double>((points[i] - points[i - 1]).norm());
  }
  CHECK(in_order_mm < 0.1 * as_given_mm);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) REQUIRE(order[i] == i);
  CHECK(pipeline::spatial_order({}).empty());
  CHECK(pipeline::spatial_order(std::vector<Vec3f>(3, Vec3f(1, 2, 3))) == std::vector<std::uint32_t>{0, 1, 2});
}
