// Pose<To, From>: a rigid motion whose type tells the frames, so that poses cannot be chained the wrong way round.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace beltpick {

using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;

// The frames of the design. Camera: OpenCV (x right, y down, z away). Belt: z up, x along travel.
namespace frame {
struct Camera;
struct Projector;
struct Belt;
struct Robot;
struct Part;
struct Gripper;
}  // namespace frame

// X_to = rotation * X_from + translation_mm. Read T_belt_camera as "takes camera points to the belt frame".
template <class To, class From>
struct Pose {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation_mm = Vec3::Zero();

  [[nodiscard]] Vec3 operator*(const Vec3& point_from_mm) const { return rotation * point_from_mm + translation_mm; }

  template <class Origin>
  [[nodiscard]] Pose<To, Origin> operator*(const Pose<From, Origin>& inner) const {
    return {rotation * inner.rotation, rotation * inner.translation_mm + translation_mm};
  }

  [[nodiscard]] Pose<From, To> inverse() const {
    const Mat3 transposed = rotation.transpose();
    return {transposed, -(transposed * translation_mm)};
  }

  [[nodiscard]] Mat4 matrix() const {
    Mat4 m = Mat4::Identity();
    m.topLeftCorner<3, 3>() = rotation;
    m.topRightCorner<3, 1>() = translation_mm;
    return m;
  }

  friend bool operator==(const Pose&, const Pose&) = default;

  static Pose from_matrix(const Mat4& m) { return {m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>()}; }
};

// The angle of the rotation that takes `a` to `b`, in radians, [0, pi].
inline double rotation_between_rad(const Mat3& a, const Mat3& b) {
  return Eigen::AngleAxisd(Mat3(a.transpose() * b)).angle();
}

}  // namespace beltpick
