#include "virtual_cell/render/settle.hpp"

#include <algorithm>
#include <limits>

#include "virtual_cell/render/contact_field.hpp"
#include "virtual_cell/render/rigid_bodies.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kTimeLimitS = 3.0;
constexpr double kStillMmPerS = 4.0;
constexpr double kStillForS = 0.15;
constexpr double kTouchMm = 0.4;
constexpr double kFarMm = 3.0;

}  // namespace

struct Settler::State {
  std::span<const ScenePart> parts;
  std::vector<ContactField> fields;
  std::vector<std::vector<PointGroup>> groups;  // of each part

  [[nodiscard]] std::vector<RigidBody> bodies(const Scene& scene) const;
  [[nodiscard]] double gap_mm(const Scene& scene, std::size_t index, bool with_belt) const;
  void raise_over_all(Scene& scene, std::size_t index) const;
};

std::vector<RigidBody> Settler::State::bodies(const Scene& scene) const {
  std::vector<RigidBody> bodies;
  for (const BeltPart& placed : scene) {
    bodies.emplace_back(parts[placed.part], fields[placed.part], groups[placed.part], placed.T_belt_part);
  }
  return bodies;
}

// The smallest signed gap of a part to the other parts (both ways round) and, where asked, the belt.
double Settler::State::gap_mm(const Scene& scene, std::size_t index, bool with_belt) const {
  const std::vector<RigidBody> all = bodies(scene);
  const int chosen = static_cast<int>(index);
  double gap = kFarMm;
  for (int a = 0; a < static_cast<int>(all.size()); ++a) {
    for (int b = with_belt && a == chosen ? kBeltBody : 0; b < static_cast<int>(all.size()); ++b) {
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

// Moves a part straight up until it is kFarMm higher than all others.
void Settler::State::raise_over_all(Scene& scene, std::size_t index) const {
  double top = 0.0;
  double lowest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < scene.size(); ++i) {
    for (const Vec3f& v : parts[scene[i].part].mesh.vertex_mm) {
      const double z = (scene[i].T_belt_part * v.cast<double>()).z();
      if (i == index) lowest = std::min(lowest, z);
      if (i != index) top = std::max(top, z);
    }
  }
  scene[index].T_belt_part.translation_mm.z() += top + kFarMm - lowest;
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
  state_->raise_over_all(scene, index);
  Vec3& at = scene[index].T_belt_part.translation_mm;
  while (true) {
    at.z() -= 1.0;
    if (state_->gap_mm(scene, index, true) < gap_mm) break;
  }
  at.z() += 1.0;
}

void Settler::lower_onto(Scene& scene, std::size_t index, double gap_mm) const {
  state_->raise_over_all(scene, index);
  Vec3& at = scene[index].T_belt_part.translation_mm;
  for (double gap = state_->gap_mm(scene, index, true); gap > gap_mm; gap = state_->gap_mm(scene, index, true)) {
    at.z() -= gap - 0.5 * gap_mm;
  }
}

bool Settler::settle(Scene& scene) const {
  std::vector<RigidBody> bodies = state_->bodies(scene);
  ContactDynamics dynamics;
  double still_s = 0.0;
  for (double time_s = 0.0; time_s < kTimeLimitS && still_s < kStillForS; time_s += ContactDynamics::kStepS) {
    dynamics.step(bodies);
    const bool still = std::all_of(bodies.begin(), bodies.end(),
                                   [](const RigidBody& body) { return body.speed_mm_per_s() < kStillMmPerS; });
    still_s = still ? still_s + ContactDynamics::kStepS : 0.0;
  }
  for (std::size_t i = 0; i < scene.size(); ++i) scene[i].T_belt_part = bodies[i].pose();
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
