// Triangulation against OpenCV's projection of known points, on rigs of several sizes, lenses and directions.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "base/camera_noise.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "range/triangulator.hpp"

namespace beltpick::testing {
namespace {

struct Rig {
  const char* name;
  double distance_mm;
  double turn_deg;  // of the projector about the axis across the baseline
  bool beside;      // the projector stands beside the camera, else above it
  double camera_k1, projector_k1, tangential;
};

const std::vector<Rig> kRigs = {
    {"the design's", 700, 30, true, -0.12, 0.08, 0.0008},
    {"near, strong lenses", 250, 20, true, -0.35, -0.25, 0.004},
    {"far", 2500, 15, true, -0.05, 0.02, -0.001},
    {"projector above the camera", 700, 25, false, -0.1, 0.1, 0.001},
};

Calibration make_calibration(const Rig& rig, int width, int height) {
  Calibration calibration;
  const double focal_px = 1.8 * width;
  calibration.camera = {width,
                        height,
                        focal_px,
                        1.01 * focal_px,
                        0.49 * width,
                        0.52 * height,
                        {rig.camera_k1, 0.05, rig.tangential, -rig.tangential, 0.01}};
  calibration.projector = {
      912, 1140, 1700, 1710, 450, 600, {rig.projector_k1, 0.02, -rig.tangential, rig.tangential, 0.0}};
  const Vec3 axis = rig.beside ? Vec3::UnitY() : Vec3::UnitX();
  const double turn = rad_from_deg(rig.beside ? rig.turn_deg : -rig.turn_deg);
  auto& pose = calibration.T_projector_camera;
  pose.rotation = Eigen::AngleAxisd(turn, axis).toRotationMatrix();
  // Both axes meet in the middle of the view.
  const Vec3 target(0.0, 0.0, rig.distance_mm);
  pose.translation_mm = target - pose.rotation * target;
  return calibration;
}

cv::Matx33d matrix_of(const Lens& lens) { return {lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1}; }

std::vector<double> distortion_of(const Lens& lens) { return {lens.distortion.begin(), lens.distortion.end()}; }

cv::Point2d ray_of(const Lens& lens, int row, int col) {
  std::vector<cv::Point2d> seen{{static_cast<double>(col), static_cast<double>(row)}};
  std::vector<cv::Point2d> ideal;
  cv::undistortPoints(seen, ideal, matrix_of(lens), distortion_of(lens), cv::noArray(), cv::noArray(),
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-14));
  return ideal.front();
}

cv::Point2d project(const Calibration& calibration, const Vec3& point_camera_mm) {
  const Vec3 p = calibration.T_projector_camera * point_camera_mm;
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, cv::Vec3d(), cv::Vec3d(),
                    matrix_of(calibration.projector), distortion_of(calibration.projector), pixels);
  return pixels.front();
}

// A code image and the points it was made from.
struct Coded {
  int rows, cols;
  std::vector<Vec3> truth;
  std::vector<float> column, row, modulation;
  std::vector<std::uint8_t> texture;
  std::vector<PixelState> state;

  CodeImage view(bool columns, bool row_codes) {
    CodeImage code;
    if (columns) code.column_px = {column.data(), rows, cols};
    if (row_codes) code.row_px = {row.data(), rows, cols};
    code.modulation = {modulation.data(), rows, cols};
    code.texture = {texture.data(), rows, cols};
    code.state = {state.data(), rows, cols};
    code.column_noise = code.row_noise = {0.0F, 1.2F};
    return code;
  }
};

template <class DepthOf>
Coded code_scene(const Calibration& calibration, DepthOf depth_mm) {
  const int rows = calibration.camera.height;
  const int cols = calibration.camera.width;
  Coded coded{rows, cols, {}, {}, {}, {}, {}, {}};
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const cv::Point2d ray = ray_of(calibration.camera, r, c);
      coded.truth.emplace_back(Vec3(ray.x, ray.y, 1.0) * depth_mm(r, c));
      const cv::Point2d pixel = project(calibration, coded.truth.back());
      const bool lit = pixel.x >= -0.5 && pixel.y >= -0.5 && pixel.x < 911.5 && pixel.y < 1139.5;
      coded.column.push_back(lit ? static_cast<float>(pixel.x) : NAN);
      coded.row.push_back(lit ? static_cast<float>(pixel.y) : NAN);
    }
  }
  coded.modulation.assign(coded.truth.size(), 60.0F);
  coded.texture.assign(coded.truth.size(), 128);
  coded.state.assign(coded.truth.size(), PixelState::kValid);
  return coded;
}

class OwnTriangulator {
 public:
  OwnTriangulator(int rows, int cols)
      : block_(bytes(rows, cols)), arena_(block_.data(), block_.bytes()), triangulator_(arena_, rows, cols) {}
  range::Triangulator* operator->() { return &triangulator_; }

 private:
  static std::size_t bytes(int rows, int cols) {
    Arena measuring;
    const range::Triangulator triangulator(measuring, rows, cols);
    return measuring.used_bytes();
  }
  ArenaBlock block_;
  Arena arena_;
  range::Triangulator triangulator_;
};

double worst_error_mm(const RangeImage& range, const Coded& coded, int& points) {
  double worst = 0.0;
  points = 0;
  for (std::size_t i = 0; i < coded.truth.size(); ++i) {
    const Vec3f& point = range.point_mm.data[i];
    if (point.z() == 0.0F) continue;
    ++points;
    worst = std::max(worst, (point.cast<double>() - coded.truth[i]).norm());
  }
  return worst;
}

constexpr int kRows = 48;
constexpr int kCols = 64;

TEST_CASE("points come back from their projector coordinates on any rig") {
  // The second width leaves a block of pixels in part, and rows that start anywhere in memory.
  const int cols = GENERATE(kCols, 77);
  for (const Rig& rig : kRigs) {
    INFO(rig.name << ", " << cols << " columns");
    const Calibration calibration = make_calibration(rig, cols, kRows);
    Coded coded = code_scene(
        calibration, [&](int r, int c) { return rig.distance_mm * (1.0 + 0.002 * (r - 24) - 0.001 * (c - 32)); });
    OwnTriangulator triangulator(kRows, cols);
    REQUIRE(triangulator->load(calibration));
    const int lit = static_cast<int>(
        std::count_if(coded.column.begin(), coded.column.end(), [](float x) { return !std::isnan(x); }));
    REQUIRE(lit > 500);
    for (const auto& [columns, row_codes] : {std::pair{true, true}, std::pair{rig.beside, !rig.beside}}) {
      const auto range = triangulator->measure(coded.view(columns, row_codes));
      REQUIRE(range);
      int points = 0;
      // Float codes resolve 6e-5 px.
      CHECK(worst_error_mm(*range, coded, points) < 2e-5 * rig.distance_mm);
      CHECK(points > 0.98 * lit);
    }
  }
}

TEST_CASE("the predicted noise is the noise that comes out") {
  const Calibration calibration = make_calibration(kRigs.front(), kCols, kRows);
  Coded coded = code_scene(calibration, [](int, int) { return 700.0; });
  const float sigma_px = 1.2F * std::sqrt(kCameraNoise.variance(64.0F)) / 60.0F;
  Random random(5);
  for (float& x : coded.column) {
    double normal = -6.0;
    for (int i = 0; i < 12; ++i) normal += random.uniform();
    x += static_cast<float>(normal) * sigma_px;
  }
  OwnTriangulator triangulator(kRows, kCols);
  REQUIRE(triangulator->load(calibration));
  const auto range = triangulator->measure(coded.view(true, false));
  REQUIRE(range);
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < coded.truth.size(); ++i) {
    if (range->point_mm.data[i].z() == 0.0F) continue;
    squares +=
        std::pow((range->point_mm.data[i].cast<double>().norm() - coded.truth[i].norm()) / range->sigma_mm.data[i], 2);
    ++count;
  }
  REQUIRE(count > 500);
  CHECK(std::sqrt(squares / count) == Approx(1.0).margin(0.1));
}

TEST_CASE("codes of both axes that contradict each other give no point") {
  const Calibration calibration = make_calibration(kRigs.front(), kCols, kRows);
  Coded coded = code_scene(calibration, [](int, int) { return 700.0; });
  const std::size_t i = 20 * kCols + 30;
  coded.column[i] += 16.0F;  // another fringe order: another depth, another row
  coded.row[i] += 16.0F;
  OwnTriangulator triangulator(kRows, kCols);
  REQUIRE(triangulator->load(calibration));
  const auto range = triangulator->measure(coded.view(true, true));
  REQUIRE(range);
  CHECK_FALSE(range->valid(20, 30));
  CHECK(triangulator->counts().axes_disagree == 1);
}

TEST_CASE("a calibration of another image size is refused") {
  const Calibration calibration = make_calibration(kRigs.front(), kCols, kRows);
  Coded coded = code_scene(make_calibration(kRigs.front(), kCols - 8, kRows), [](int, int) { return 700.0; });
  OwnTriangulator triangulator(kRows, kCols);
  REQUIRE(triangulator->load(calibration));
  CHECK(triangulator->measure(coded.view(true, false)).error().code == ResultCode::kCalibrationMismatch);
  CHECK(OwnTriangulator(8, 8)->load(calibration).error().code == ResultCode::kLimitExceeded);
}

}  // namespace
}  // namespace beltpick::testing
