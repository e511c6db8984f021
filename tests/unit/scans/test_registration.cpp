#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "scan_maker.hpp"
#include "scans/adjust.hpp"
#include "scans/join.hpp"
#include "scans/stitch.hpp"
#include "support/shapes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

using TruePose = Pose<frame::Camera, frame::Part>;

Mat3 turned(double x_deg, double y_deg, double z_deg) {
  return (Eigen::AngleAxisd(rad_from_deg(x_deg), Vec3::UnitX()) *
          Eigen::AngleAxisd(rad_from_deg(y_deg), Vec3::UnitY()) * Eigen::AngleAxisd(rad_from_deg(z_deg), Vec3::UnitZ()))
      .toRotationMatrix();
}

struct Scans {
  std::vector<scans::ScanView> views;
  std::vector<TruePose> truth;

  void add(const Mesh& mesh, const Mat3& rotation, double noise_mm = 0.03) {
    TruePose pose;
    SmallScan scan = take_scan(mesh, rotation, noise_mm, views.size() + 1, pose);
    auto view = scans::make_view(scan.source("scan " + std::to_string(views.size())), scan.part());
    REQUIRE(view.has_value());
    views.push_back(std::move(*view));
    truth.push_back(pose);
  }
  // How far the pose of scan `i` (to the first one's camera) is off, at 40 mm from the part's origin.
  [[nodiscard]] double off_mm(std::size_t i, const scans::ScanPose& pose) const {
    double worst = 0.0;
    for (const Vec3& at : {Vec3(40, 0, 0), Vec3(0, 40, 0), Vec3(0, 0, 40)})
      worst = std::max(worst, (pose * (truth[i] * at) - truth[0] * at).norm());
    return worst;
  }
};

// The bracket from above, and turned by steps about its length.
Scans bracket_all_round() {
  Scans scans;
  for (const double x : {180.0, 230.0, 290.0, 340.0, 40.0}) scans.add(bracket(), turned(x, 20.0, x));
  return scans;
}

}  // namespace

TEST_CASE("adjustment brings scans together from some millimetres off", "[scans]") {
  const Scans scans = bracket_all_round();
  std::vector<const scans::ScanView*> views;
  std::vector<scans::ScanPose> poses;
  for (std::size_t i = 0; i < scans.views.size(); ++i) {
    views.push_back(&scans.views[i]);
    const auto T_first_scan = scans.truth[0] * scans.truth[i].inverse();
    poses.push_back({T_first_scan.rotation, T_first_scan.translation_mm});
  }
  poses[1].rotation = poses[1].rotation * turned(0.8, -0.5, 0.7);
  poses[1].translation_mm -= poses[1] * Vec3(0, 0, 480) - scans.truth[0] * (scans.truth[1].inverse() * Vec3(0, 0, 480));
  poses[1].translation_mm += Vec3(2.0, -1.5, 1.0);
  REQUIRE(scans.off_mm(1, poses[1]) > 2.0);
  const std::array<scans::AdjustStage, 3> stages{scans::AdjustStage{5.0, 15, 1000}, scans::AdjustStage{2.0, 15, 2000},
                                                 scans::AdjustStage{0.7, 15, 4000}};
  const auto ties = scans::adjust(views, poses, stages);
  for (std::size_t i = 1; i < views.size(); ++i) CHECK(scans.off_mm(i, poses[i]) < 0.45);  // of pixels of 0.5 mm
  CHECK(ties.size() >= 4);
}

TEST_CASE("scans are joined without any start", "[scans]") {
  const Scans scans = bracket_all_round();
  int told = 0;
  const auto joined =
      scans::join(scans.views, [&](int done, int total) { told = done == ++told && total == 10 ? told : -99; });
  REQUIRE(joined.has_value());
  CHECK(told == 10);
  // So near that the adjustment of all brings them together; pairs by themselves end within 0.3 to 2 mm.
  for (std::size_t i = 1; i < scans.views.size(); ++i) CHECK(scans.off_mm(i, joined->T_part_scan[i]) < 2.5);
  CHECK(joined->seconds.empty());
}

TEST_CASE("stitched scans say how well they fit and how the part lies", "[scans]") {
  const Scans scans = bracket_all_round();
  const auto stitched = scans::stitch(scans.views);
  REQUIRE(stitched.has_value());
  CHECK(stitched->residual_mm < 0.12);
  REQUIRE(stitched->scans.size() == 5);
  for (std::size_t i = 1; i < scans.views.size(); ++i) {
    const auto T_first_scan = stitched->scans[0].T_part_scan.inverse() * stitched->scans[i].T_part_scan;
    CHECK(scans.off_mm(i, {T_first_scan.rotation, T_first_scan.translation_mm}) < 0.45);  // of pixels of 0.5 mm
  }
  CHECK(stitched->scans[0].shared > 0.05);
  // The part stands on the plane z = 0 of its frame, as in the first scan.
  float lowest = 1e9F;
  for (const Vec3f& p : stitched->surface.vertex_mm) lowest = std::min(lowest, p.z());
  CHECK(lowest == Approx(0.0).margin(0.5));
  CHECK(stitched->surface.vertex_mm.size() == stitched->surface.vertex_normal.size());
}

TEST_CASE("scans of two parts, or of sides that share nothing, are refused by name", "[scans]") {
  Scans two;
  for (const double x : {180.0, 230.0}) two.add(bracket(), turned(x, 20.0, x));
  Mesh other = box(70, 30, 20);
  add_cylinder(other, {20, 15, 20}, 9, 30);
  two.add(other, turned(170, 10, 0));
  const auto refused = scans::join(two.views, {});
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().code == ResultCode::kNothingFound);
  CHECK(refused.error().text().starts_with("scan 2: "));

  Scans sheet;  // its two sides share no surface
  sheet.add(box(80, 50, 2), turned(0, 0, 0));
  Mesh far_side = box(80, 50, 2);
  add_cylinder(far_side, {20, 15, 2}, 8, 12);
  sheet.add(far_side, turned(180, 0, 0));
  CHECK_FALSE(scans::join(sheet.views, {}).has_value());
}
