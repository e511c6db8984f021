// Derivatives against differences, and the file that keeps the corners.
#include <catch2/catch.hpp>

#include "calibrate/lens_derivatives.hpp"
#include "calibrate/observations_io.hpp"
#include "contract/result_codes.hpp"
#include "support/temp_folder.hpp"
#include "synthetic_plates.hpp"

using namespace beltpick;
using namespace beltpick::test;

TEST_CASE("the image's derivatives are those of the plain projection", "[calibrate]") {
  const Lens lens = sample_rig().projector;
  const Vec3 point_mm(90.0, -120.0, 720.0);
  const auto plain = [](const Lens& l, const Vec3& p) {
    const PixelPosition at = project(l, p);
    return Eigen::Vector2d(at.column_px, at.row_px);
  };
  const auto found = calibrate::project_with_derivatives(lens, point_mm);
  CHECK((found.at_px - plain(lens, point_mm)).norm() < 1e-9);
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = 1e-3 * Vec3::Unit(i);
    const Eigen::Vector2d slope = (plain(lens, point_mm + step) - plain(lens, point_mm - step)) / 2e-3;
    CHECK((found.by_point.col(i) - slope).norm() < 1e-6);
  }
  for (int i = 0; i < calibrate::kLensParameters; ++i) {
    const double size = i < 4 ? 1e-2 : 1e-5;
    const calibrate::LensVector step = size * calibrate::LensVector::Unit(i);
    const calibrate::LensVector at = calibrate::vector_of(lens);
    const Eigen::Vector2d slope =
        (plain(calibrate::lens_of(at + step, lens), point_mm) - plain(calibrate::lens_of(at - step, lens), point_mm)) /
        (2.0 * size);
    INFO("parameter " << i);
    CHECK((found.by_lens.col(i) - slope).norm() < 1e-6 * (1.0 + slope.norm()));
  }
}

TEST_CASE("kept corners come back as they were", "[calibrate]") {
  const TempFolder folder;
  PlateSet set;
  set.poses = 3;
  calibrate::Observations seen = observe_plates(sample_rig(), set);
  seen.board.marker_mm = 15.0;
  seen.board.dictionary = "DICT_5X5_100";
  seen.poses[1].corners[5].no_projector_reason = "dark";
  seen.left_out.push_back({"pose9", -1, "no plate"});
  REQUIRE(calibrate::write_observations(folder / "seen.json", seen));
  contract_io::Warnings warnings;
  const auto back = calibrate::read_observations(folder / "seen.json", warnings);
  REQUIRE(back);
  CHECK(warnings.empty());
  CHECK(back->board.dictionary == "DICT_5X5_100");
  CHECK(back->camera_width == 1280);
  CHECK(back->projector.height == 1140);
  REQUIRE(back->poses.size() == 3);
  REQUIRE(back->poses[1].corners.size() == 88);
  CHECK(back->poses[2].corners[7].camera_px.row_px == seen.poses[2].corners[7].camera_px.row_px);
  CHECK(back->poses[2].corners[7].projector_by_camera == seen.poses[2].corners[7].projector_by_camera);
  CHECK(std::count_if(back->poses[1].corners.begin(), back->poses[1].corners.end(),
                      [](const auto& c) { return !c.has_projector(); }) == 1);
  CHECK(back->left_out.front().reason == "no plate");
}

TEST_CASE("a file of corners that cannot be is refused by name", "[calibrate]") {
  const TempFolder folder;
  const auto refused = [&](const std::string& board, const std::string& corners) {
    const std::string file = folder.file(
        "seen.json", R"({"format": "beltpick-calibration-observations", "version": 1, "board": )" + board +
                         R"(, "camera": {"width": 640, "height": 480}, "projector": {"width": 100, "height": 100},
                         "poses": [{"capture": "a", "corners": )" +
                         corners + R"(, "unlit": []}], "left_out": []})");
    contract_io::Warnings warnings;
    const auto read = calibrate::read_observations(file, warnings);
    REQUIRE_FALSE(read);
    CHECK(read.error().text().find("seen.json") != std::string_view::npos);
    return read.error().code;
  };
  const std::string board = R"({"columns": 4, "rows": 3, "square_mm": 10})";
  CHECK(refused(board, "[[12, 1, 2, 3, 4, 1, 0, 0, 1, 0.1]]") == ResultCode::kValueOutOfRange);
  CHECK(refused(board, "[[1e300, 1, 2, 3, 4, 1, 0, 0, 1, 0.1]]") == ResultCode::kValueOutOfRange);
  CHECK(refused(board, "[[1, 1, 2, 3, 4, 1, 0, 0, 1, 0.1], [1, 1, 2, 3, 4, 1, 0, 0, 1, 0.1]]") ==
        ResultCode::kValueOutOfRange);
  CHECK(refused(board, "[[1, 1, 2]]") == ResultCode::kFormatInvalid);
  CHECK(refused(R"({"columns": 2, "rows": 3, "square_mm": 10})", "[]") == ResultCode::kValueOutOfRange);
}
