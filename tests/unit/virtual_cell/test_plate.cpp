// The calibration plate: its print, its bend, how it is held, and that the image shows its corners where OpenCV's own
// projection has them.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/units.hpp"
#include "contract_io/truth_io.hpp"
#include "virtual_cell/render/plate_poses.hpp"
#include "virtual_cell/render/target_scene.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

Plate default_plate(std::uint64_t seed = 3) { return Plate::make({}, seed).value(); }

// OpenCV's own projection with all twelve terms of the rich lens.
std::vector<cv::Point2d> project(const RichLens& lens, const std::vector<Vec3>& points_mm) {
  std::vector<cv::Point3d> points;
  for (const Vec3& p : points_mm) points.emplace_back(p.x(), p.y(), p.z());
  const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  const std::vector<double> distortion{lens.k[0], lens.k[1], lens.p1,   lens.p2,   lens.k[2], lens.k[3],
                                       lens.k[4], lens.k[5], lens.s[0], lens.s[1], lens.s[2], lens.s[3]};
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), matrix, distortion, pixels);
  return pixels;
}

// Ink under a rectangle, by counting points of a chessboard written down again.
double counted_ink(const Board& board, double x, double y, double width_x, double width_y) {
  constexpr int kSteps = 400;
  int ink = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double column = std::floor((x + width_x * ((i + 0.5) / kSteps - 0.5)) / board.square_mm) + 1;
      const double row = std::floor((y + width_y * ((j + 0.5) / kSteps - 0.5)) / board.square_mm) + 1;
      const bool inside = column >= 0 && row >= 0 && column <= board.columns && row <= board.rows;
      ink += inside && std::fmod(column + row, 2.0) == 0.0 ? 1 : 0;
    }
  }
  return ink / static_cast<double>(kSteps * kSteps);
}

}  // namespace

TEST_CASE("the share of ink in a pixel is the print's area in it") {
  const Board board{5, 4, 7.0, false};
  const BoardPrint print = BoardPrint::make(board).value();
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{
           {0.0, 0.0}, {0.06, 0.02}, {-3.0, -7.02}, {-7.0, -7.0}, {35.05, 27.9}, {14.1, 10.0}, {80.0, 0.0}}) {
    for (const double width : {0.08, 0.3, 9.0}) {
      CHECK(print.ink_share(static_cast<float>(x), static_cast<float>(y), static_cast<float>(width), 0.2F) ==
            Approx(counted_ink(board, x, y, width, 0.2)).margin(0.006));
    }
  }
}

TEST_CASE("a ChArUco print has a marker framed in ink in each light square, the squares as a chessboard's") {
  const Board board{5, 4, 16.0, true};
  const BoardPrint print = BoardPrint::make(board).value();
  const auto ink = [&](double x, double y) {
    return print.ink_share(static_cast<float>(x), static_cast<float>(y), 0.01F, 0.01F);
  };
  CHECK(ink(-8.0, -8.0) == 1.0F);                                    // the first square is dark
  for (const double at : {0.5, 15.5}) CHECK(ink(at, -8.0) == 0.0F);  // the next light, with a light rim
  CHECK(ink(3.0, -8.0) == 1.0F);                                     // and the marker's frame
  // DICT_4X4_100's first marker, as printed in every manual: 1011 0101 0011 0010, 1 light.
  const char* const rows[] = {"1011", "0101", "0011", "0010"};
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) CHECK(ink(5.0 + 2.0 * c, -11.0 + 2.0 * r) == (rows[r][c] == '1' ? 0.0F : 1.0F));
  }
  CHECK(!BoardPrint::make({20, 20, 10.0, true}));
  CHECK(!BoardPrint::make({2, 8, 10.0, false}));
}

TEST_CASE("a plate is closed, bent by what is asked, and the same for the same seed") {
  const Plate plate = default_plate();
  const ScenePart part = plate.part().value();
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& face : part.mesh.face) {
    for (int i = 0; i < 3; ++i) ++edges[{face[i], face[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    REQUIRE(count == 1);
    REQUIRE(edges.contains({edge.second, edge.first}));
  }
  double low = 1e9, high = -1e9, left = 1e9, right = -1e9;
  for (const Vec3f& v : part.mesh.vertex_mm) {
    if (v.z() > 1.0F) continue;  // the back
    CHECK(static_cast<double>(v.z()) == Approx(plate.bow_mm(v.x(), v.y())).margin(1e-5));
    low = std::min(low, static_cast<double>(v.z()));
    high = std::max(high, static_cast<double>(v.z()));
    left = std::min(left, static_cast<double>(v.x()));
    right = std::max(right, static_cast<double>(v.x()));
  }
  CHECK(high - low == Approx(0.05).margin(1e-3));
  CHECK(left == Approx(-30.0));
  CHECK(right == Approx(230.0));
  CHECK(plate.bow_mm(10, 20) == default_plate().bow_mm(10, 20));
  CHECK(plate.bow_mm(10, 20) != default_plate(4).bow_mm(10, 20));
  PlateOptions impossible;
  impossible.bend_mm = -1.0;
  CHECK(!Plate::make(impossible, 1));
}

TEST_CASE("a careful person's plates are whole in view and lit, off the belt, tilted to all sides, high and low") {
  RigOptions other;
  other.camera_width = 1920;
  other.camera_height = 1200;
  other.angle_deg = -24;
  other.field_width_mm = 480;
  for (const RigOptions& options : {RigOptions{}, other}) {
    const Rig rig = make_rig(options).value();
    const Plate plate = default_plate();
    const ScenePart part = plate.part().value();
    const auto poses = choose_plate_poses(rig, plate, PlatePoses::kGood, 15, 8).value();
    REQUIRE(poses.size() == 15);
    double lowest = 1e9, highest = -1e9;
    Eigen::AlignedBox2d leaning;
    int tilted = 0;
    for (const auto& pose : poses) {
      std::vector<Vec3> seen, lit;
      for (const Vec3& corner : plate.outline_mm(plate.options().quiet_zone_mm, 4)) {
        seen.push_back(rig.T_camera_belt * pose * corner);
        lit.push_back(rig.T_projector_camera * seen.back());
      }
      for (const cv::Point2d& p : project(rig.camera, seen)) {
        CHECK((p.x > 0 && p.y > 0 && p.x < rig.camera.width - 1 && p.y < rig.camera.height - 1));
      }
      for (const cv::Point2d& p : project(rig.projector, lit)) {
        CHECK((p.x > 0 && p.y > 0 && p.x < rig.projector.width - 1 && p.y < rig.projector.height - 1));
      }
      for (const Vec3f& v : part.mesh.vertex_mm) REQUIRE((pose * v.cast<double>()).z() > -0.1);
      const Vec3 normal = -pose.rotation.col(2);
      leaning.extend(Eigen::Vector2d(normal.head<2>()));
      tilted += normal.z() < std::cos(rad_from_deg(12.0)) ? 1 : 0;
      const double height = (pose * plate.centre_mm()).z();
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
    CHECK(tilted >= 10);
    CHECK(leaning.min().maxCoeff() < -0.2);
    CHECK(leaning.max().minCoeff() > 0.2);
    CHECK(lowest < 30.0);
    CHECK(highest > 70.0);
  }
}

TEST_CASE("careless people hold the plate flat, always alike, or out of view; too large a plate is refused") {
  const Rig rig = make_rig().value();
  const Plate plate = default_plate();
  const auto poses = [&](PlatePoses how) { return choose_plate_poses(rig, plate, how, 6, 8).value(); };
  for (const auto& pose : poses(PlatePoses::kFlat)) CHECK(pose.rotation(2, 2) == Approx(-1.0));
  for (const auto& pose : poses(PlatePoses::kOnBelt)) {
    CHECK((pose * plate.centre_mm()).z() == Approx(plate.options().thickness_mm).margin(0.06));
  }
  const auto near = poses(PlatePoses::kNear);
  for (const auto& pose : near) CHECK(rotation_between_rad(pose.rotation, near[0].rotation) < 0.2);
  int cut = 0;
  for (const auto& pose : poses(PlatePoses::kPartial)) {
    const TargetScene scene = plate_scene(rig, plate, pose);
    const auto gone = std::ranges::count_if(scene.plate->corner_camera_px, [&](const Eigen::Vector2d& p) {
      return p.x() < 0 || p.y() < 0 || p.x() > rig.camera.width - 1 || p.y() > rig.camera.height - 1;
    });
    cut += gone > 20 && gone < 60 ? 1 : 0;
  }
  CHECK(cut == 4);
  PlateOptions huge;
  huge.board.square_mm = 60.0;
  CHECK(choose_plate_poses(rig, Plate::make(huge, 1).value(), PlatePoses::kGood, 3, 1).error().text().find("260") ==
        std::string_view::npos);
  CHECK(choose_plate_poses(rig, Plate::make(huge, 1).value(), PlatePoses::kGood, 3, 1).error().text().find("720") !=
        std::string_view::npos);
}

TEST_CASE("the image shows the plate's corners where they are, to hundredths of a pixel") {
  const Rig rig = make_rig().value();
  const Plate plate = default_plate();
  const std::vector<ScenePart> parts{plate.part().value()};
  RenderOptions options;
  options.camera_blur_px = 0.4;
  SceneRenderer renderer(rig, parts, options);
  const auto poses = choose_plate_poses(rig, plate, PlatePoses::kGood, 4, 5).value();
  for (const std::size_t k : {0U, 2U}) {
    const TargetScene scene = plate_scene(rig, plate, poses[k]);
    std::vector<Vec3> seen;
    for (const Vec3& corner : scene.plate->corner_plate_mm) seen.push_back(scene.plate->T_camera_plate * corner);
    const std::vector<cv::Point2d> expected = project(rig.camera, seen);
    renderer.place(scene.instances, 5);
    cv::Mat image(rig.camera.height, rig.camera.width, CV_8U);
    FrameSpec white;
    white.kind = FrameKind::kWhite;
    renderer.expose(white, options.nominal_exposure_us, 5.0, {image.data, rig.camera.height, rig.camera.width});
    std::vector<cv::Point2f> corners(expected.begin(), expected.end());
    cv::cornerSubPix(image, corners, {6, 6}, {-1, -1}, {3, 60, 1e-4});
    cv::Point2d mean(0, 0);
    double squares = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      CHECK((scene.plate->corner_camera_px[i] - Eigen::Vector2d(expected[i].x, expected[i].y)).norm() < 1e-6);
      const cv::Point2d error = cv::Point2d(corners[i]) - expected[i];
      mean += error / static_cast<double>(corners.size());
      squares += error.dot(error) / (2.0 * static_cast<double>(corners.size()));
      CHECK(cv::norm(error) < 0.2);
    }
    CHECK(std::sqrt(squares) < 0.06);
    CHECK(std::max(std::abs(mean.x), std::abs(mean.y)) < 0.015);
    // Ink is dark, not black.
    const auto level = [&](double x_mm, double y_mm) {
      const auto pixel = rig.camera.project(scene.plate->T_camera_plate * Vec3(x_mm, y_mm, 0.0));
      return static_cast<double>(image.at<std::uint8_t>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x())));
    };
    CHECK(level(-10, -10) > 0.05 * level(10, -10));
    CHECK(level(-10, -10) < 0.25 * level(10, -10));
  }
}

TEST_CASE("truth.json carries the plate and the targets") {
  const Rig rig = make_rig().value();
  const TargetScene scene = plate_scene(rig, default_plate(), {Mat3::Identity(), Vec3(1, 2, 3)});
  Truth truth;
  truth.plate = scene.plate;
  TrueTarget sphere{TrueTarget::Kind::kSphere, 2, {1, 2, 600}, Vec3::Zero(), 20.0, 0.0};
  TrueTarget plane{TrueTarget::Kind::kPlane, 3, {4, 5, 600}, {0, 0, -1}, 0.0, 40.0};
  truth.targets = {sphere, plane};
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "beltpick_test_plate_truth.json";
  REQUIRE(contract_io::write_truth(file, truth));
  contract_io::Warnings warnings;
  const auto read = contract_io::read_truth(file, warnings);
  std::filesystem::remove(file);
  REQUIRE(read);
  CHECK(warnings.empty());
  REQUIRE(read->plate);
  CHECK(read->plate->columns == 11);
  CHECK(read->plate->width_mm == 260.0);
  CHECK((read->plate->T_camera_plate.matrix() - scene.plate->T_camera_plate.matrix()).norm() < 1e-9);
  REQUIRE(read->plate->corner_plate_mm.size() == 88);
  for (std::size_t i = 0; i < 88; ++i) {
    CHECK((read->plate->corner_plate_mm[i] - scene.plate->corner_plate_mm[i]).norm() < 1e-9);
    CHECK((read->plate->corner_camera_px[i] - scene.plate->corner_camera_px[i]).norm() < 1e-9);
    CHECK((read->plate->corner_projector_px[i] - scene.plate->corner_projector_px[i]).norm() < 1e-9);
  }
  REQUIRE(read->targets.size() == 2);
  CHECK(read->targets[0].radius_mm == 20.0);
  CHECK(read->targets[0].point_camera_mm == sphere.point_camera_mm);
  CHECK(read->targets[1].normal_camera == plane.normal_camera);
  CHECK(read->targets[1].height_mm == 40.0);
}
