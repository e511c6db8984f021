// Gauss-Newton on the nine parameters of one lens; the model is smooth and nearly linear in them.
#include "virtual_cell/render/rig_calibration.hpp"

#include <Eigen/Cholesky>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace beltpick::virtual_cell {
namespace {

using Parameters = Eigen::Matrix<double, 9, 1>;  // fx, fy, cx, cy, k1, k2, p1, p2, k3

struct Observation {
  Eigen::Vector2d ideal;  // normalised coordinates
  Eigen::Vector2d pixel;  // as the true lens images them
};

RichLens simple_lens(const RichLens& like, const Parameters& p) {
  RichLens lens{.width = like.width, .height = like.height};
  lens.fx_px = p[0];
  lens.fy_px = p[1];
  lens.cx_px = p[2];
  lens.cy_px = p[3];
  lens.k = {p[4], p[5], p[8], 0.0, 0.0, 0.0};
  lens.p1 = p[6];
  lens.p2 = p[7];
  return lens;
}

Eigen::Vector2d residual(const RichLens& like, const Parameters& p, const Observation& seen) {
  return simple_lens(like, p).project({seen.ideal.x(), seen.ideal.y(), 1.0}) - seen.pixel;
}

struct Fit {
  Lens lens;
  double rms_px = 0.0;
};

Fit fit_lens(const RichLens& truth, const std::vector<Observation>& observations) {
  Parameters p;
  p << truth.fx_px, truth.fy_px, truth.cx_px, truth.cy_px, truth.k[0], 0.0, 0.0, 0.0, 0.0;
  // Steps that move the pixel by comparable amounts, for the numeric derivatives.
  Parameters step;
  step << 1e-2, 1e-2, 1e-2, 1e-2, 1e-5, 1e-5, 1e-6, 1e-6, 1e-5;
  double squares = 0.0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
    Parameters gradient = Parameters::Zero();
    squares = 0.0;
    for (const Observation& seen : observations) {
      Eigen::Matrix<double, 2, 9> jacobian;
      for (int i = 0; i < 9; ++i) {
        Parameters up = p;
        Parameters down = p;
        up[i] += step[i];
        down[i] -= step[i];
        jacobian.col(i) = (residual(truth, up, seen) - residual(truth, down, seen)) / (2.0 * step[i]);
      }
      const Eigen::Vector2d error = residual(truth, p, seen);
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * error;
      squares += error.squaredNorm();
    }
    p -= normal.ldlt().solve(gradient);
  }
  Fit fit;
  fit.lens = {truth.width, truth.height, p[0], p[1], p[2], p[3], {p[4], p[5], p[6], p[7], p[8]}};
  fit.rms_px = std::sqrt(squares / (2.0 * static_cast<double>(observations.size())));
  return fit;
}

// A grid of points through the working volume: every part of the image, from below the belt to above the parts.
std::vector<Vec3> working_volume(const Rig& rig) {
  std::vector<Vec3> points;
  const Vec3 up = rig.T_camera_belt.rotation.col(2);
  const double belt = up.dot(rig.T_camera_belt.translation_mm);
  for (const double height_mm : {-10.0, 25.0, 60.0, kPartHeightMm}) {
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; j <= 16; ++j) {
        const Vec3 ray = rig.camera.ray({(rig.camera.width - 1) * i / 20.0, (rig.camera.height - 1) * j / 16.0});
        points.push_back(ray * ((belt + height_mm) / up.dot(ray)));
      }
    }
  }
  return points;
}

// The same for the same optics, another for others: a cell file must not fit another rig (FNV-1a over the numbers).
std::string identity_of(const Calibration& calibration) {
  std::uint64_t hash = 14695981039346656037ULL;
  const auto add = [&hash](double number) {
    for (auto bits = std::bit_cast<std::uint64_t>(number); bits != 0; bits >>= 8U) {
      hash = (hash ^ (bits & 0xffU)) * 1099511628211ULL;
    }
  };
  for (const Lens* lens : {&calibration.camera, &calibration.projector}) {
    for (const double number : {lens->fx_px, lens->fy_px, lens->cx_px, lens->cy_px}) add(number);
    for (const double number : lens->distortion) add(number);
  }
  const Mat4 projector_camera = calibration.T_projector_camera.matrix();
  for (const double number : projector_camera.reshaped()) add(number);
  char text[32];
  std::snprintf(text, sizeof text, "virtual-%08x", static_cast<unsigned>(hash >> 32U));
  return text;
}

}  // namespace

RigCalibration calibrate_rig(const Rig& rig) {
  std::vector<Observation> camera;
  std::vector<Observation> projector;
  for (const Vec3& point : working_volume(rig)) {
    camera.push_back({point.head<2>() / point.z(), rig.camera.project(point)});
    const Vec3 lit = rig.T_projector_camera * point;
    projector.push_back({lit.head<2>() / lit.z(), rig.projector.project(lit)});
  }
  const Fit camera_fit = fit_lens(rig.camera, camera);
  const Fit projector_fit = fit_lens(rig.projector, projector);
  RigCalibration result;
  result.camera_rms_px = camera_fit.rms_px;
  result.projector_rms_px = projector_fit.rms_px;
  result.calibration.camera_serial = "BP0001";
  result.calibration.projector_serial = "VC-PROJECTOR-1";
  result.calibration.camera = camera_fit.lens;
  result.calibration.projector = projector_fit.lens;
  result.calibration.T_projector_camera = rig.T_projector_camera;
  result.calibration.id = identity_of(result.calibration);
  return result;
}

Cell make_cell(const Rig& rig, const Calibration& calibration) {
  Cell cell;
  cell.calibration_id = calibration.id;
  cell.T_belt_camera = rig.T_camera_belt.inverse();
  cell.T_robot_camera = rig.T_robot_belt * rig.T_camera_belt.inverse();
  return cell;
}

}  // namespace beltpick::virtual_cell
