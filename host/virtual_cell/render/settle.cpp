#include "virtual_cell/render/settle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Geometry>

#include "virtual_cell/render/contact_field.hpp"
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
constexpr double kStepS = 5.0e-5;
constexpr double kTimeLimitS = 3.0;
constexpr double kStillMmPerS = 4.0;
constexpr double kStillForS = 0.15;
constexpr int kRefreshSteps = 64;
constexpr double kNearMm = 1.2;  // points nearer than this to another surface are watched until the next refresh
constexpr double kContactSpacingMm = 2.5;
constexpr double kGroupMm = 6.0;
constexpr double kTouchMm = 0.4;
constexpr double kFarMm = 3.0;
constexpr int kBelt = -1;

// Points of the surface that lie together, relative to the centre of mass; looked at only where the group comes near.
struct PointGroup {
  Vec3 middle = Vec3::Zero();
  double radius_mm = 0.0;
  std::vector<Vec3> points;
};

struct Body {
  const ScenePart* part = nullptr;
  const ContactField* field = nullptr;
  const std::vector<PointGroup>* groups = nullptr;
  Vec3 centre_mm;
  Eigen::Quaterniond turn;
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();  // rad/s, belt frame
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  Mat3 inertia_per_mass;  // part frame
  double radius_mm = 0.0;
  Mat3 rotation;

  [[nodiscard]] Vec3 to_part(const Vec3& belt_mm) const {
    return rotation.transpose() * (belt_mm - centre_mm) + part->centre_of_mass_mm;
  }
};

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

// Signed gap of a point to the belt or to a body; at least the field's band where it is farther.
double gap_to(const std::vector<Body>& bodies, int other, const Vec3& belt_mm) {
  if (other == kBelt) return belt_mm.z();
  const Body& body = bodies[other];
  const double beyond = (belt_mm - body.centre_mm).norm() - body.radius_mm;
  return beyond > body.field->band_mm() ? beyond : body.field->distance(body.to_part(belt_mm));
}

// All vertices and, on large triangles, points between them, grouped by cubes.
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

Pose<frame::Belt, frame::Part> pose_of(const Body& body) {
  return {body.rotation, body.centre_mm - body.rotation * body.part->centre_of_mass_mm};
}

}  // namespace

struct Settler::State {
  std::span<const ScenePart> parts;
  std::vector<ContactField> fields;
  std::vector<std::vector<PointGroup>> groups;  // of each part

  [[nodiscard]] std::vector<Body> bodies(const Scene& scene) const;
  [[nodiscard]] static std::vector<Watch> watches(const std::vector<Body>& bodies);
  static void find_contacts(const std::vector<Body>& bodies, const std::vector<Watch>& watches,
                            std::vector<Contact>& contacts);
  static void press(std::vector<Body>& bodies, const Contact& contact, double sharing);
  static void move(Body& body);
  static void step(std::vector<Body>& bodies, const std::vector<Watch>& watches, std::vector<Contact>& contacts);
  [[nodiscard]] double gap_mm(const Scene& scene, std::size_t index, bool with_belt) const;
};

std::vector<Body> Settler::State::bodies(const Scene& scene) const {
  std::vector<Body> bodies;
  for (const BeltPart& placed : scene) {
    Body body;
    body.part = &parts[placed.part];
    body.field = &fields[placed.part];
    body.groups = &groups[placed.part];
    body.rotation = placed.T_belt_part.rotation;
    body.turn = Eigen::Quaterniond(body.rotation);
    body.centre_mm = placed.T_belt_part * body.part->centre_of_mass_mm;
    body.inertia_per_mass = body.part->inertia_mm5 / body.part->volume_mm3;
    for (const PointGroup& group : *body.groups)
      body.radius_mm = std::max(body.radius_mm, group.middle.norm() + group.radius_mm);
    bodies.push_back(body);
  }
  return bodies;
}

std::vector<Watch> Settler::State::watches(const std::vector<Body>& bodies) {
  std::vector<Watch> watched;
  for (int a = 0; a < static_cast<int>(bodies.size()); ++a) {
    for (const PointGroup& group : *bodies[a].groups) {
      const Vec3 middle = bodies[a].centre_mm + bodies[a].rotation * group.middle;
      for (int b = kBelt; b < static_cast<int>(bodies.size()); ++b) {
        if (b == a || gap_to(bodies, b, middle) > group.radius_mm + kNearMm) continue;
        for (const Vec3& point : group.points) {
          const Vec3 p = bodies[a].centre_mm + bodies[a].rotation * point;
          if (gap_to(bodies, b, p) < kNearMm) watched.push_back({a, b, &point});
        }
      }
    }
  }
  return watched;
}

// The contacts of this moment.
void Settler::State::find_contacts(const std::vector<Body>& bodies, const std::vector<Watch>& watches,
                                   std::vector<Contact>& contacts) {
  contacts.clear();
  for (const Watch& watch : watches) {
    const Body& body = bodies[watch.body];
    const Vec3 arm = body.rotation * *watch.point;
    const Vec3 p = body.centre_mm + arm;
    Vec3 normal = Vec3::UnitZ();
    double depth = -p.z();
    if (watch.other != kBelt) {
      const Body& other = bodies[watch.other];
      const Vec3 local = other.to_part(p);
      depth = -other.field->distance(local);
      if (depth > 0.0) normal = other.rotation * other.field->outward(local);
    }
    if (depth > 0.0) contacts.push_back({watch, arm, normal, depth});
  }
}

// Pressure along the normal and Coulomb friction across it. The contacts between two bodies share the stiffness, so
// that faces and corners are alike stiff.
void Settler::State::press(std::vector<Body>& bodies, const Contact& contact, double sharing) {
  Body& body = bodies[contact.watch.body];
  Body* other = contact.watch.other == kBelt ? nullptr : &bodies[contact.watch.other];
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

// Semi-implicit Euler.
void Settler::State::move(Body& body) {
  body.velocity += kStepS * (body.force / body.part->volume_mm3 - kLinearDrag * body.velocity);
  const Mat3 inertia = body.rotation * body.inertia_per_mass * body.rotation.transpose();
  const Vec3 gyration = body.spin.cross(inertia * body.spin);
  const Vec3 moment = body.torque / body.part->volume_mm3 - gyration;
  body.spin += kStepS * (inertia.inverse() * moment - kAngularDrag * body.spin);
  body.centre_mm += kStepS * body.velocity;
  const Vec3 turn = kStepS * body.spin;
  if (turn.norm() > 1e-15) {
    body.turn = Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * body.turn;
    body.turn.normalize();
  }
  body.rotation = body.turn.toRotationMatrix();
}

void Settler::State::step(std::vector<Body>& bodies, const std::vector<Watch>& watches,
                          std::vector<Contact>& contacts) {
  find_contacts(bodies, watches, contacts);
  const std::size_t side = bodies.size() + 1;
  // Between two bodies, whichever holds the point: how many contacts share the load, counted by depth so that the
  // number changes smoothly as contacts come and go.
  std::vector<double> depth(side * side, 0.0), depth2(side * side, 0.0);
  const auto pair = [side](const Watch& watch) {
    const auto low = static_cast<std::size_t>(std::min(watch.body, watch.other) + 1);
    return low * side + static_cast<std::size_t>(std::max(watch.body, watch.other) + 1);
  };
  for (const Contact& contact : contacts) {
    depth[pair(contact.watch)] += contact.depth;
    depth2[pair(contact.watch)] += contact.depth * contact.depth;
  }
  for (Body& body : bodies) {
    body.force = body.part->volume_mm3 * Vec3(0.0, 0.0, -kGravity);
    body.torque.setZero();
  }
  for (const Contact& contact : contacts) {
    const std::size_t at = pair(contact.watch);
    press(bodies, contact, depth[at] * depth[at] / depth2[at]);
  }
  for (Body& body : bodies) move(body);
}

// The smallest signed gap of a part to the other parts (both ways round) and, where asked, the belt.
double Settler::State::gap_mm(const Scene& scene, std::size_t index, bool with_belt) const {
  const std::vector<Body> all = bodies(scene);
  const int chosen = static_cast<int>(index);
  double gap = kFarMm;
  for (int a = 0; a < static_cast<int>(all.size()); ++a) {
    for (int b = with_belt && a == chosen ? kBelt : 0; b < static_cast<int>(all.size()); ++b) {
      if (a == b || (a != chosen && b != chosen)) continue;
      for (const PointGroup& group : *all[a].groups) {
        const Vec3 middle = all[a].centre_mm + all[a].rotation * group.middle;
        if (gap_to(all, b, middle) > gap + group.radius_mm) continue;
        for (const Vec3& point : group.points) {
          gap = std::min(gap, gap_to(all, b, all[a].centre_mm + all[a].rotation * point));
        }
      }
    }
  }
  return gap;
}

Settler::Settler(std::span<const ScenePart> parts) : state_(std::make_unique<State>()) {
  state_->parts = parts;
  for (const ScenePart& part : parts) {
    state_->fields.emplace_back(part);
    state_->groups.push_back(point_groups(part));
  }
}
Settler::~Settler() = default;
Settler::Settler(Settler&&) noexcept = default;

void Settler::lift_clear(Scene& scene, std::size_t index, double gap_mm) const {
  Vec3& at = scene[index].T_belt_part.translation_mm;
  double top = 0.0;
  double lowest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < scene.size(); ++i) {
    for (const Vec3f& v : state_->parts[scene[i].part].mesh.vertex_mm) {
      const double z = (scene[i].T_belt_part * v.cast<double>()).z();
      if (i == index) lowest = std::min(lowest, z);
      if (i != index) top = std::max(top, z);
    }
  }
  at.z() += top + kFarMm - lowest;
  while (true) {
    at.z() -= 1.0;
    if (state_->gap_mm(scene, index, true) < gap_mm) break;
  }
  at.z() += 1.0;
}

bool Settler::settle(Scene& scene) const {
  std::vector<Body> bodies = state_->bodies(scene);
  std::vector<Watch> watches;
  std::vector<Contact> contacts;
  double still_s = 0.0;
  for (int n = 0; n * kStepS < kTimeLimitS && still_s < kStillForS; ++n) {
    if (n % kRefreshSteps == 0) watches = State::watches(bodies);
    State::step(bodies, watches, contacts);
    double fastest = 0.0;
    for (const Body& body : bodies)
      fastest = std::max(fastest, body.velocity.norm() + body.spin.norm() * body.radius_mm);
    still_s = fastest < kStillMmPerS ? still_s + kStepS : 0.0;
  }
  for (std::size_t i = 0; i < scene.size(); ++i) scene[i].T_belt_part = pose_of(bodies[i]);
  if (still_s < kStillForS) return false;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    for (int n = 0; n < 20 && penetration_mm(scene, i) > 0.5 * kMaxPenetrationMm; ++n) {
      scene[i].T_belt_part.translation_mm.z() += 0.02;
    }
    if (penetration_mm(scene, i) > kMaxPenetrationMm) return false;
  }
  return true;
}

double Settler::penetration_mm(const Scene& scene, std::size_t index) const {
  return std::max(0.0, -state_->gap_mm(scene, index, true));
}

bool Settler::touch(const Scene& scene, std::size_t index) const {
  return state_->gap_mm(scene, index, false) < kTouchMm;
}

}  // namespace beltpick::virtual_cell
