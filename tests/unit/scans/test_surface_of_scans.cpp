#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "scan_maker.hpp"
#include "scans/coverage.hpp"
#include "scans/merge.hpp"
#include "scans/part_frame.hpp"
#include "support/shapes.hpp"
#include "teach/surface.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

Mesh points_of(const Mesh& mesh, std::size_t count) {
  const auto surface = teach::sample_mesh(mesh, count, 1);
  return {surface->point_mm, surface->normal, {}};
}

}  // namespace

TEST_CASE("what one scan has where another saw nothing is dropped, the rest is smoothed", "[scans]") {
  std::vector<scans::ScanView> views;
  std::vector<scans::ScanPose> poses;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Pose<frame::Camera, frame::Part> truth;
    SmallScan scan = take_scan(box(60, 40, 25), Mat3::Identity(), 0.1, seed, truth);
    auto view = scans::make_view(scan.source("scan"), scan.part());
    REQUIRE(view.has_value());
    views.push_back(std::move(*view));
    poses.emplace_back();
  }
  // A crumb that stands beside the box in the first scan alone.
  const float top = views[0].point[0].point_mm.z();
  for (int i = 0; i < 40; ++i)
    views[0].point[static_cast<std::size_t>(i)] = {
        {45.0F + 0.2F * static_cast<float>(i % 6), 0.2F * static_cast<float>(i) / 6.0F, top}, {0, 0, -1}};
  const scans::Merged merged = scans::merge(views, poses);
  CHECK(merged.dropped >= 40);
  CHECK(merged.dropped < 200);
  double squares = 0.0;
  int on_top = 0;
  for (std::size_t i = 0; i < merged.surface.vertex_mm.size(); ++i) {
    const Vec3f& p = merged.surface.vertex_mm[i];
    CHECK(p.x() < 40.0F);
    if (std::abs(p.x()) > 27.0F || std::abs(p.y()) > 17.0F) continue;
    squares += std::pow(static_cast<double>(p.z()) - 475.0, 2);
    ++on_top;
  }
  REQUIRE(on_top > 1000);
  CHECK(std::sqrt(squares / on_top) < 0.05);  // of 0.1 mm of noise
}

TEST_CASE("the side that no scan saw is named", "[scans]") {
  Mesh whole = points_of(box(80, 50, 30), 20000);
  CHECK(scans::find_missing(whole, 0.9).front().missing_share < 0.03);
  Mesh open;
  for (std::size_t i = 0; i < whole.vertex_mm.size(); ++i) {
    if (whole.vertex_normal[i].z() < -0.5F) continue;
    open.vertex_mm.push_back(whole.vertex_mm[i]);
    open.vertex_normal.push_back(whole.vertex_normal[i]);
  }
  const auto sides = scans::find_missing(open, 0.9);
  CHECK(sides.front().name == "underside (-z)");
  CHECK(sides.front().missing_share > 0.9);
}

TEST_CASE("the part frame stands on the belt, x along the part", "[scans]") {
  Mesh surface = points_of(box(80, 30, 20), 8000);
  const Mat3 lying = (Eigen::AngleAxisd(kPi, Vec3::UnitX()) * Eigen::AngleAxisd(0.3, Vec3::UnitZ())).toRotationMatrix();
  for (Vec3f& p : surface.vertex_mm) p = (lying * p.cast<double>() + Vec3(30, -20, 500)).cast<float>();
  scans::ScanView first;
  first.belt = Plane{-Vec3::UnitZ(), -500.0};
  const auto motion = scans::part_frame(surface, first);
  Vec3f low = Vec3f::Constant(1e9F), high = -low;
  for (const Vec3f& p : surface.vertex_mm) {
    const Vec3f at = (motion * p.cast<double>()).cast<float>();
    low = low.cwiseMin(at), high = high.cwiseMax(at);
  }
  CHECK((high - low - Vec3f(80, 30, 20)).norm() < 1.5F);
  CHECK((low + Vec3f(40, 15, 0)).norm() < 1.5F);
}
