// Rigid bodies in contact with each other and the belt: what a settling scene is made of.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "virtual_cell/render/contact_field.hpp"
#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

inline constexpr int kBeltBody = -1;

// Points of the surface that lie together, relative to the centre of mass; looked at only where the group comes near.
struct PointGroup {
  Vec3 middle = Vec3::Zero();
  double radius_mm = 0.0;
  std::vector<Vec3> points;
};

// All vertices of a part and, on large triangles, points between them.
std::vector<PointGroup> point_groups(const ScenePart& part);

// Belt frame, mm and s; mass is volume.
struct RigidBody {
  const ScenePart* part = nullptr;
  const ContactField* field = nullptr;
  const std::vector<PointGroup>* groups = nullptr;
  Vec3 centre_mm = Vec3::Zero();  // of mass
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Mat3 rotation = Mat3::Identity();
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();  // rad/s
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  Mat3 inertia_per_mass = Mat3::Identity();  // part frame
  double radius_mm = 0.0;

  RigidBody(const ScenePart& part, const ContactField& field, const std::vector<PointGroup>& groups,
            const Pose<frame::Belt, frame::Part>& T_belt_part);

  [[nodiscard]] Vec3 to_part(const Vec3& belt_mm) const {
    return rotation.transpose() * (belt_mm - centre_mm) + part->centre_of_mass_mm;
  }
  [[nodiscard]] Pose<frame::Belt, frame::Part> pose() const {
    return {rotation, centre_mm - rotation * part->centre_of_mass_mm};
  }
  // Of the fastest point.
  [[nodiscard]] double speed_mm_per_s() const { return velocity.norm() + spin.norm() * radius_mm; }
};

// Signed gap of a point to the belt or to a body; at least the field's band where it is farther.
double gap_to(const std::vector<RigidBody>& bodies, int other, const Vec3& belt_mm);

// Moves bodies in time under gravity, stiff contacts, Coulomb friction and drag.
class ContactDynamics {
 public:
  static constexpr double kStepS = 5.0e-5;

  void step(std::vector<RigidBody>& bodies);

 private:
  // A point of one body watched against the belt or another body.
  struct Watch {
    int body, other;
    const Vec3* point;
  };
  struct Contact {
    Watch watch;
    Vec3 arm, normal;
    double depth;
  };

  void watch(const std::vector<RigidBody>& bodies);
  void find_contacts(const std::vector<RigidBody>& bodies);
  static void press(std::vector<RigidBody>& bodies, const Contact& contact, double sharing);

  int steps_ = 0;
  std::vector<Watch> watched_;
  std::vector<Contact> contacts_;
};

}  // namespace beltpick::virtual_cell
