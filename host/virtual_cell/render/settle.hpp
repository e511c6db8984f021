// Settler: lets parts come to rest on the belt and on each other, as gravity, contact and friction have it.
#pragma once

#include <memory>
#include <span>

#include "virtual_cell/render/belt_part.hpp"

namespace beltpick::virtual_cell {

class Settler {
 public:
  // Works out each part's contact field. `parts` must outlive the settler.
  explicit Settler(std::span<const ScenePart> parts);
  ~Settler();
  Settler(Settler&&) noexcept;

  // Moves part `index` straight up or down until its lowest gap to belt and other parts is `gap_mm`.
  void lift_clear(Scene& scene, std::size_t index, double gap_mm) const;

  // Lets part `index` straight down from above all others until it nearly touches one, or the belt: at most `gap_mm`
  // is left. Quick, against settling.
  void lower_onto(Scene& scene, std::size_t index, double gap_mm) const;

  // Rigid bodies with stiff contacts and Coulomb friction, strongly damped, until nothing moves; what still
  // interpenetrates by more than kMaxPenetrationMm is lifted out. False when the parts do not come to rest in time.
  [[nodiscard]] bool settle(Scene& scene) const;

  // Deepest interpenetration of part `index` with another part or the belt, mm.
  [[nodiscard]] double penetration_mm(const Scene& scene, std::size_t index) const;
  // Whether part `index` touches another part.
  [[nodiscard]] bool touch(const Scene& scene, std::size_t index) const;

  static constexpr double kMaxPenetrationMm = 0.15;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace beltpick::virtual_cell
