// The rig's lenses, layout and the calibration that is written for it.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/rig_calibration.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

TEST_CASE("a lens's ray goes back to the pixel it came from") {
  const Rig rig = make_rig().value();
  for (const RichLens& lens : {rig.camera, rig.projector}) {
    for (int i = 0; i <= 6; ++i) {
      for (int j = 0; j <= 6; ++j) {
        const Eigen::Vector2d pixel((lens.width - 1) * i / 6.0, (lens.height - 1) * j / 6.0);
        CHECK((lens.project(550.0 * lens.ray(pixel)) - pixel).norm() < 1e-6);
      }
    }
  }
}

TEST_CASE("the default rig is the design's") {
  const Rig rig = make_rig().value();
  CHECK(rig.camera.width == 1280);
  CHECK(rig.projector.height == 1140);
  const Vec3 projector_axis = rig.T_projector_camera.rotation.row(2);
  CHECK(deg_from_rad(std::acos(projector_axis.dot(Vec3::UnitZ()))) == Approx(30.0).margin(0.5));
  // 400 x 300 mm in view at the belt.
  const auto on_belt = [&](double x, double y) {
    const Vec3 ray = rig.camera.ray({x, y});
    const Vec3 up = rig.T_camera_belt.rotation.col(2);
    return Vec3(rig.T_camera_belt.inverse() * Vec3(ray * (up.dot(rig.T_camera_belt.translation_mm) / up.dot(ray))));
  };
  CHECK((on_belt(1279, 480) - on_belt(0, 480)).norm() == Approx(400.0).margin(10.0));
  CHECK((on_belt(640, 959) - on_belt(640, 0)).norm() == Approx(300.0).margin(10.0));
}

TEST_CASE("every rig's projector lights the whole field up to the height of the parts") {
  RigOptions other;
  other.camera_width = 2048;
  other.camera_height = 1536;
  other.projector_width = 1280;
  other.projector_height = 800;
  other.camera_distance_mm = 950;
  other.projector_distance_mm = 900;
  other.field_width_mm = 520;
  RigOptions other_side;
  other_side.angle_deg = -22;
  for (const RigOptions& options : {RigOptions{}, other, other_side}) {
    const Rig rig = make_rig(options).value();
    for (const double x : {0.0, rig.camera.width - 1.0}) {
      for (const double y : {0.0, rig.camera.height - 1.0}) {
        const Vec3 ray = rig.camera.ray({x, y});
        const Vec3 up = rig.T_camera_belt.rotation.col(2);
        for (const double height_mm : {0.0, kPartHeightMm}) {
          const Vec3 point = ray * ((up.dot(rig.T_camera_belt.translation_mm) + height_mm) / up.dot(ray));
          const Eigen::Vector2d lit = rig.projector.project(rig.T_projector_camera * point);
          CHECK(lit.x() > -0.5);
          CHECK(lit.x() < rig.projector.width - 0.5);
          CHECK(lit.y() > -0.5);
          CHECK(lit.y() < rig.projector.height - 0.5);
        }
      }
    }
  }
}

TEST_CASE("five parameters leave what a good calibration would leave") {
  const RigCalibration fit = calibrate_rig(make_rig().value());
  CHECK(fit.camera_rms_px > 0.005);  // the lenses are richer than the model
  CHECK(fit.camera_rms_px < 0.04);
  CHECK(fit.projector_rms_px > 0.005);
  CHECK(fit.projector_rms_px < 0.04);
  RigOptions ideal;
  ideal.distortion = 0.0;
  const RigCalibration exact = calibrate_rig(make_rig(ideal).value());
  CHECK(exact.camera_rms_px < 1e-6);
  CHECK(exact.projector_rms_px < 1e-6);
}

TEST_CASE("what five parameters leave costs hundredths of a millimetre in the working volume") {
  const Rig rig = make_rig().value();
  const RigCalibration fit = calibrate_rig(rig);
  const auto as_rich = [](const Lens& lens) {
    RichLens rich{.width = lens.width, .height = lens.height};
    rich.fx_px = lens.fx_px;
    rich.fy_px = lens.fy_px;
    rich.cx_px = lens.cx_px;
    rich.cy_px = lens.cy_px;
    rich.k = {lens.distortion[0], lens.distortion[1], lens.distortion[4], 0.0, 0.0, 0.0};
    rich.p1 = lens.distortion[2];
    rich.p2 = lens.distortion[3];
    return rich;
  };
  const RichLens camera = as_rich(fit.calibration.camera);
  const RichLens projector = as_rich(fit.calibration.projector);
  double squares = 0.0, worst = 0.0;
  int points = 0;
  for (const double height_mm : {0.0, 50.0, 100.0}) {
    for (int i = 0; i <= 24; ++i) {
      for (int j = 0; j <= 18; ++j) {
        const Vec3 up = rig.T_camera_belt.rotation.col(2);
        const Eigen::Vector2d pixel(1279 * i / 24.0, 959 * j / 18.0);
        const Vec3 ray = rig.camera.ray(pixel);
        const Vec3 point = ray * ((up.dot(rig.T_camera_belt.translation_mm) + height_mm) / up.dot(ray));
        const double column = rig.projector.project(rig.T_projector_camera * point).x();
        // Along the calibrated ray to where the calibrated projector has the column, by the secant method.
        const Vec3 seen = camera.ray(pixel);
        const auto miss = [&](double z) {
          return projector.project(rig.T_projector_camera * Vec3(z * seen)).x() - column;
        };
        double near = point.z() - 1.0, z = point.z() + 1.0;
        for (int step = 0; step < 6; ++step) {
          const double next = z - miss(z) * (z - near) / (miss(z) - miss(near));
          near = z;
          z = next;
          if (std::abs(z - near) < 1e-9) break;
        }
        const double error = (z * seen - point).norm();
        squares += error * error;
        worst = std::max(worst, error);
        ++points;
      }
    }
  }
  const double rms_mm = std::sqrt(squares / points);
  INFO("camera " << fit.camera_rms_px << " px, projector " << fit.projector_rms_px << " px, " << rms_mm
                 << " mm RMS, worst " << worst << " mm");
  CHECK(rms_mm > 0.005);
  CHECK(rms_mm < 0.025);
}

TEST_CASE("a rig's file is read strictly") {
  const std::string path = "/tmp/beltpick_test_rig.toml";
  const auto read = [&](const char* text) {
    std::ofstream(path) << text;
    auto options = read_rig_options(path);
    std::remove(path.c_str());
    return options;
  };
  CHECK(read("camera_width = 640\nangle_deg = 25.5\nlayout = \"diamond\"\n")->angle_deg == 25.5);
  CHECK(read("camera_width = \"wide\"\n").error().text().find("camera_width: expected an integer") !=
        std::string_view::npos);
  CHECK(read("camera_widht = 640\n").error().text().find("camera_widht: no such member") != std::string_view::npos);
  CHECK(read("= 3\n").error().code == ResultCode::kFormatInvalid);
  CHECK(read_rig_options("/nowhere/rig.toml").error().code == ResultCode::kFileNotFound);
  RigOptions flat;
  flat.angle_deg = 1.0;
  CHECK(make_rig(flat).error().text().find("angle_deg") != std::string_view::npos);
}
