#include "calibrate/first_guess.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::calibrate {
namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4>;

struct CvPose {
  std::size_t pose = 0;
  std::vector<cv::Point3f> plate;
  std::vector<cv::Point2f> image;
};

std::vector<CvPose> camera_views(const Observations& seen, const Selection& use) {
  std::vector<CvPose> views;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    if (!use.pose[p]) continue;
    CvPose view{p, {}, {}};
    for (std::size_t i = 0; i < seen.poses[p].corners.size(); ++i) {
      if (!use.corner[p][i]) continue;
      const ObservedCorner& corner = seen.poses[p].corners[i];
      const Vec3 flat = seen.board.flat_mm(corner.corner);
      view.plate.emplace_back(static_cast<float>(flat.x()), static_cast<float>(flat.y()), 0.0F);
      view.image.emplace_back(static_cast<float>(corner.camera_px.column_px),
                              static_cast<float>(corner.camera_px.row_px));
    }
    views.push_back(std::move(view));
  }
  return views;
}

PlatePosition pose_of(const cv::Mat& turn, const cv::Mat& shift) {
  cv::Mat rotation;
  cv::Rodrigues(turn, rotation);
  PlatePosition pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.rotation(r, c) = rotation.at<double>(r, c);
    pose.translation_mm[r] = shift.at<double>(r);
  }
  return pose;
}

std::unexpected<Error> undetermined(const char* what) {
  return failure(ResultCode::kCheckFailed,
                 "the poses do not determine the %s; tilt the plate by 20 to 40 degrees about both axes, near and far, "
                 "all over the view",
                 what);
}

// Zhang's method, without tangential and sixth-order distortion, which the refinement adds.
bool guess_camera(const Observations& seen, const std::vector<CvPose>& views, BundleState& state) {
  std::vector<std::vector<cv::Point3f>> plates;
  std::vector<std::vector<cv::Point2f>> images;
  for (const CvPose& view : views) {
    plates.push_back(view.plate);
    images.push_back(view.image);
  }
  cv::Mat matrix, distortion;
  std::vector<cv::Mat> turns, shifts;
  try {
    cv::calibrateCamera(plates, images, {seen.camera_width, seen.camera_height}, matrix, distortion, turns, shifts,
                        cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3);
  } catch (const cv::Exception&) {
    return false;
  }
  Lens& lens = state.rig.camera;
  lens = {seen.camera_width,
          seen.camera_height,
          matrix.at<double>(0, 0),
          matrix.at<double>(1, 1),
          matrix.at<double>(0, 2),
          matrix.at<double>(1, 2),
          {distortion.at<double>(0), 0, 0, 0, 0}};
  for (std::size_t v = 0; v < views.size(); ++v) state.T_camera_plate[views[v].pose] = pose_of(turns[v], shifts[v]);
  const double longest = std::max(seen.camera_width, seen.camera_height);
  return std::isfinite(lens.fx_px) && lens.fx_px > 0.1 * longest && lens.fx_px < 100.0 * longest &&
         std::isfinite(lens.distortion[0]);
}

struct LitPoint {
  Vec3 camera_mm;
  Eigen::Vector2d projector_px;
};

std::vector<LitPoint> lit_points(const Observations& seen, const Selection& use, const BundleState& state) {
  std::vector<LitPoint> points;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    for (std::size_t i = 0; i < seen.poses[p].corners.size(); ++i) {
      if (!use.has(p, i) || !use.projector[p][i]) continue;
      const ObservedCorner& corner = seen.poses[p].corners[i];
      points.push_back({state.T_camera_plate[p] * state.plate_mm(seen.board, corner.corner),
                        {corner.projector_px.column_px, corner.projector_px.row_px}});
    }
  }
  return points;
}

Eigen::Vector2d image_of(const Matrix34& matrix, const Vec3& point_mm) {
  return (matrix * point_mm.homogeneous()).hnormalized();
}

// The 3 x 4 matrix by the direct linear transform, in coordinates of mean 0 and size 1.
Matrix34 linear_transform(const std::vector<LitPoint>& points) {
  Vec3 middle_mm = Vec3::Zero();
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  for (const LitPoint& point : points) {
    middle_mm += point.camera_mm / static_cast<double>(points.size());
    middle_px += point.projector_px / static_cast<double>(points.size());
  }
  double size_mm = 0.0, size_px = 0.0;
  for (const LitPoint& point : points) {
    size_mm += (point.camera_mm - middle_mm).norm() / static_cast<double>(points.size());
    size_px += (point.projector_px - middle_px).norm() / static_cast<double>(points.size());
  }
  Eigen::Matrix<double, 12, 12> normal = Eigen::Matrix<double, 12, 12>::Zero();
  for (const LitPoint& point : points) {
    const Eigen::Vector4d x = Vec3((point.camera_mm - middle_mm) / size_mm).homogeneous();
    const Eigen::Vector2d u = (point.projector_px - middle_px) / size_px;
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix<double, 12, 1> row = Eigen::Matrix<double, 12, 1>::Zero();
      row.segment<4>(4 * axis) = x;
      row.tail<4>() = -u[axis] * x;
      normal += row * row.transpose();
    }
  }
  const Eigen::Matrix<double, 12, 1> best =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>>(normal).eigenvectors().col(0);
  const Matrix34 scaled = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(best.data());
  Mat3 to_px = Mat3::Identity();
  to_px.topLeftCorner<2, 2>() *= size_px;
  to_px.topRightCorner<2, 1>() = middle_px;
  Mat4 to_size = Mat4::Identity();
  to_size.topLeftCorner<3, 3>() /= size_mm;
  to_size.topRightCorner<3, 1>() = -middle_mm / size_mm;
  return to_px * scaled * to_size;
}

// Without the points that lie further off than five times the median, until the choice stands.
Matrix34 robust_transform(std::vector<LitPoint> points) {
  Matrix34 matrix = linear_transform(points);
  for (int round = 0; round < 5; ++round) {
    std::vector<double> off;
    for (const LitPoint& point : points) off.push_back((image_of(matrix, point.camera_mm) - point.projector_px).norm());
    std::vector<double> sorted = off;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double limit = 5.0 * sorted[sorted.size() / 2] + 0.1;
    std::vector<LitPoint> kept;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (off[i] <= limit) kept.push_back(points[i]);
    }
    if (kept.size() == points.size() || kept.size() < 12) break;
    points = std::move(kept);
    matrix = linear_transform(points);
  }
  return matrix;
}

// matrix ~ K [R | t] with K upper triangular and positive on its diagonal; K's skew is dropped.
bool take_apart(Matrix34 matrix, const ProjectorGrid& grid, Calibration& rig) {
  if (matrix.leftCols<3>().determinant() < 0.0) matrix = -matrix;
  // RQ of M by QR of the reversed transpose.
  const Mat3 reverse = Vec3(1, 1, 1).asDiagonal().toDenseMatrix().rowwise().reverse();
  const Mat3 m = matrix.leftCols<3>();
  const Eigen::HouseholderQR<Mat3> qr((reverse * m).transpose());
  Mat3 upper = reverse * Mat3(qr.matrixQR().triangularView<Eigen::Upper>()).transpose() * reverse;
  Mat3 rotation = reverse * Mat3(qr.householderQ()).transpose();
  for (int i = 0; i < 3; ++i) {
    if (upper(i, i) >= 0.0) continue;
    upper.col(i) *= -1.0;
    rotation.row(i) *= -1.0;
  }
  if (!(upper(2, 2) > 0.0) || rotation.determinant() < 0.0) return false;
  rig.T_projector_camera = {rotation, upper.inverse() * matrix.col(3)};
  upper /= upper(2, 2);
  rig.projector = {grid.width, grid.height, upper(0, 0), upper(1, 1), upper(0, 2), upper(1, 2), {}};
  const double longest = std::max(grid.width, grid.height);
  return upper.allFinite() && rig.T_projector_camera.translation_mm.allFinite() && upper(0, 0) > 0.05 * longest &&
         upper(1, 1) > 0.05 * longest && upper(0, 0) < 200.0 * longest && upper(1, 1) < 200.0 * longest;
}

}  // namespace

Result<BundleState> first_guess(const Observations& seen, const Selection& use) {
  BundleState state;
  state.T_camera_plate.resize(seen.poses.size());
  state.height_mm.assign(static_cast<std::size_t>(seen.board.corners()), 0.0);
  if (!guess_camera(seen, camera_views(seen, use), state)) return undetermined("camera's lens");
  const std::vector<LitPoint> points = lit_points(seen, use, state);
  if (points.size() < 24 || !take_apart(robust_transform(points), seen.projector, state.rig)) {
    return undetermined("projector's lens");
  }
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    if (!use.pose[p]) continue;
    const Vec3 origin_mm = state.T_camera_plate[p].translation_mm;
    if (origin_mm.z() <= 0.0 || (state.rig.T_projector_camera * origin_mm).z() <= 0.0) {
      return undetermined("projector's lens");
    }
  }
  return state;
}

RoughTilts rough_tilts(const Observations& seen, const Selection& use) {
  const double focal = 1.4 * std::max(seen.camera_width, seen.camera_height);
  const cv::Matx33d matrix(focal, 0, seen.camera_width / 2.0, 0, focal, seen.camera_height / 2.0, 0, 0, 1);
  std::vector<double> about_x, about_y;
  for (const CvPose& view : camera_views(seen, use)) {
    cv::Mat turn, shift;
    if (view.plate.size() < 6 ||
        !cv::solvePnP(view.plate, view.image, matrix, cv::noArray(), turn, shift, false, cv::SOLVEPNP_IPPE))
      continue;
    const Vec3 normal = pose_of(turn, shift).rotation.col(2);
    about_x.push_back(deg_from_rad(std::atan2(normal.y(), normal.z())));
    about_y.push_back(deg_from_rad(std::atan2(normal.x(), normal.z())));
  }
  const auto range = [](const std::vector<double>& values) {
    if (values.empty()) return 0.0;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
  };
  return {range(about_x), range(about_y)};
}

}  // namespace beltpick::calibrate
