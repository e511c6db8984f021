#include "virtual_cell/render/rigid_bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "virtual_cell/render/surface_points.hpp"

namespace beltpick::virtual_cell {
namespace {

// All per unit of mass; mm and s. The static load on a few contacts presses them in by some hundredths of a mm.
constexpr double kGravity = 9810.0;
constexpr double kStiffness = 1.5e6;
constexpr double kDamping = 1700.0;
constexpr double kTangentialDamping = 5000.0;
constexpr double kFriction = 0.35;
constexpr double kLinearDrag = 1.0;
constexpr double kAngularDrag = 6.0;  // rolling resistance: a round part comes to rest
constexpr int kRefreshSteps = 64;
constexpr double kNearMm = 1.2;  // points nearer than this to another surface are watched until the next refresh
constexpr double kContactSpacingMm = 2.5;
constexpr double kGroupMm = 6.0;

// Semi-implicit Euler.
void move(RigidBody& body) {
  body.velocity += ContactDynamics::kStepS * (body.force / body.part->volume_mm3 - kLinearDrag * body.velocity);
  const Mat3 inertia = body.rotation * body.inertia_per_mass * body.rotation.transpose();
  const Vec3 gyration = body.spin.cross(inertia * body.spin);
  const Vec3 moment = body.torque / body.part->volume_mm3 - gyration;
  body.spin += ContactDynamics::kStepS * (inertia.inverse() * moment - kAngularDrag * body.spin);
  body.centre_mm += ContactDynamics::kStepS * body.velocity;
  const Vec3 turn = ContactDynamics::kStepS * body.spin;
  if (turn.norm() > 1e-15) {
    body.turn = Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * body.turn;
    body.turn.normalize();
  }
  body.rotation = body.turn.toRotationMatrix();
}

}  // namespace

std::vector<PointGroup> point_groups(const ScenePart& part) {
  std::map<std::array<int, 3>, std::vector<Vec3>> cubes;
  const auto add = [&](const Vec3& point_part_mm) {
    const Vec3 p = point_part_mm - part.centre_of_mass_mm;
    const Vec3 cube = (p / kGroupMm).array().floor();
    cubes[{static_cast<int>(cube.x()), static_cast<int>(cube.y()), static_cast<int>(cube.z())}].push_back(p);
  };
  for (const Vec3f& vertex : part.mesh.vertex_mm) add(vertex.cast<double>());
  for (const Vec3& point : surface_points(part, kContactSpacingMm)) add(point);
  std::vector<PointGroup> groups;
  for (auto& [cube, points] : cubes) {
    PointGroup& group = groups.emplace_back();
    group.points = std::move(points);
    for (const Vec3& p : group.points) group.middle += p / static_cast<double>(group.points.size());
    for (const Vec3& p : group.points) group.radius_mm = std::max(group.radius_mm, (p - group.middle).norm());
  }
  return groups;
}

RigidBody::RigidBody(const ScenePart& part_, const ContactField& field_, const std::vector<PointGroup>& groups_,
                     const Pose<frame::Belt, frame::Part>& T_belt_part)
    : part(&part_),
      field(&field_),
      groups(&groups_),
      centre_mm(T_belt_part * part_.centre_of_mass_mm),
      turn(T_belt_part.rotation),
      rotation(T_belt_part.rotation),
      inertia_per_mass(part_.inertia_mm5 / part_.volume_mm3) {
  for (const PointGroup& group : groups_) radius_mm = std::max(radius_mm, group.middle.norm() + group.radius_mm);
}

double gap_to(const std::vector<RigidBody>& bodies, int other, const Vec3& belt_mm) {
  if (other == kBeltBody) return belt_mm.z();
  const RigidBody& body = bodies[other];
  const double beyond = (belt_mm - body.centre_mm).norm() - body.radius_mm;
  return beyond > body.field->band_mm() ? beyond : body.field->distance(body.to_part(belt_mm));
}

void ContactDynamics::watch(const std::vector<RigidBody>& bodies) {
  watched_.clear();
  for (int a = 0; a < static_cast<int>(bodies.size()); ++a) {
    for (const PointGroup& group : *bodies[a].groups) {
      const Vec3 middle = bodies[a].centre_mm + bodies[a].rotation * group.middle;
      for (int b = kBeltBody; b < static_cast<int>(bodies.size()); ++b) {
        if (b == a || gap_to(bodies, b, middle) > group.radius_mm + kNearMm) continue;
        for (const Vec3& point : group.points) {
          const Vec3 p = bodies[a].centre_mm + bodies[a].rotation * point;
          if (gap_to(bodies, b, p) < kNearMm) watched_.push_back({a, b, &point});
        }
      }
    }
  }
}

// The contacts of this moment.
void ContactDynamics::find_contacts(const std::vector<RigidBody>& bodies) {
  contacts_.clear();
  for (const Watch& watch : watched_) {
    const RigidBody& body = bodies[watch.body];
    const Vec3 arm = body.rotation * *watch.point;
    const Vec3 p = body.centre_mm + arm;
    Vec3 normal = Vec3::UnitZ();
    double depth = -p.z();
    if (watch.other != kBeltBody) {
      const RigidBody& other = bodies[watch.other];
      const Vec3 local = other.to_part(p);
      depth = -other.field->distance(local);
      if (depth > 0.0) normal = other.rotation * other.field->outward(local);
    }
    if (depth > 0.0) contacts_.push_back({watch, arm, normal, depth});
  }
}

// Pressure along the normal and Coulomb friction across it. The contacts between two bodies share the stiffness, so
// that faces and corners are alike stiff.
void ContactDynamics::press(std::vector<RigidBody>& bodies, const Contact& contact, double sharing) {
  RigidBody& body = bodies[contact.watch.body];
  RigidBody* other = contact.watch.other == kBeltBody ? nullptr : &bodies[contact.watch.other];
  const double mass = std::min(body.part->volume_mm3, (other != nullptr ? other : &body)->part->volume_mm3);
  const double scale = mass / sharing;
  Vec3 velocity = body.velocity + body.spin.cross(contact.arm);
  const Vec3 other_arm = other != nullptr ? Vec3(body.centre_mm + contact.arm - other->centre_mm) : Vec3::Zero();
  if (other != nullptr) velocity -= other->velocity + other->spin.cross(other_arm);
  const double approach = velocity.dot(contact.normal);
  const double press = std::max(0.0, scale * (kStiffness * contact.depth - kDamping * approach));
  const Vec3 slip = velocity - approach * contact.normal;
  const double speed = slip.norm();
  Vec3 force = press * contact.normal;
  if (speed > 1e-9) force -= std::min(kFriction * press, scale * kTangentialDamping * speed) / speed * slip;
  body.force += force;
  body.torque += contact.arm.cross(force);
  if (other == nullptr) return;
  other->force -= force;
  other->torque -= other_arm.cross(force);
}

void ContactDynamics::step(std::vector<RigidBody>& bodies) {
  if (steps_++ % kRefreshSteps == 0) watch(bodies);
  find_contacts(bodies);
  const std::size_t side = bodies.size() + 1;
  // Between two bodies, whichever holds the point: how many contacts share the load, counted by depth so that the
  // number changes smoothly as contacts come and go.
  std::vector<double> depth(side * side, 0.0), depth2(side * side, 0.0);
  const auto pair = [side](const Watch& watch) {
    const auto low = static_cast<std::size_t>(std::min(watch.body, watch.other) + 1);
    return low * side + static_cast<std::size_t>(std::max(watch.body, watch.other) + 1);
  };
  for (const Contact& contact : contacts_) {
    depth[pair(contact.watch)] += contact.depth;
    depth2[pair(contact.watch)] += contact.depth * contact.depth;
  }
  for (RigidBody& body : bodies) {
    body.force = body.part->volume_mm3 * Vec3(0.0, 0.0, -kGravity);
    body.torque.setZero();
  }
  for (const Contact& contact : contacts_) {
    const std::size_t at = pair(contact.watch);
    press(bodies, contact, depth[at] * depth[at] / depth2[at]);
  }
  for (RigidBody& body : bodies) move(body);
}

}  // namespace beltpick::virtual_cell
