#include "pipeline/plan_search.hpp"

#include <algorithm>

#include "base/units.hpp"

namespace beltpick::pipeline {
namespace {

// Of a part that was not rehearsed: the paper's 36 degrees land in wrong basins of ICP, 15 do not.
constexpr double kTurn_rad = rad_from_deg(15.0);
constexpr double kShiftShare = 0.035;  // of the part's diagonal
constexpr double kFaceShare = 0.06;
// ICP comes home from farther than Q can tell a pose from its neighbours: half a step must keep most of the part nearer
// than where distances in Q are capped (coarse_radius_mm).
constexpr double kCoarsestTurn_rad = rad_from_deg(18.0);
constexpr double kCoarsestShiftShare = 0.05;
constexpr double kFinestTurn_rad = rad_from_deg(10.0);
constexpr double kFinestShiftShare = 0.02;

void plan_steps(const SearchSteps& steps, PartModel& model) {
  const double shift_mm = kShiftShare * model.diagonal_mm;
  const double face_mm = kFaceShare * model.diagonal_mm;
  const double coarsest_mm = kCoarsestShiftShare * model.diagonal_mm;
  const bool taught = steps.turn_rad > 0.0 && steps.shift_mm > 0.0;
  model.turn_step_rad = taught ? std::clamp(steps.turn_rad, kFinestTurn_rad, kCoarsestTurn_rad) : kTurn_rad;
  model.shift_step_mm =
      taught ? std::clamp(steps.shift_mm, kFinestShiftShare * model.diagonal_mm, coarsest_mm) : shift_mm;
  model.face_step_mm = std::max(face_mm, model.shift_step_mm);
}

}  // namespace

void plan_search(const PartTemplate& part, PartModel& model) {
  plan_steps(part.steps, model);
  model.route_count = 0;
  const auto add = [&](int primitive) {
    model.routes[static_cast<std::size_t>(model.route_count++)] = static_cast<std::uint8_t>(primitive);
  };
  for (const RecognitionRoute& route : part.routes) {
    if (route.primitive >= 0 && route.primitive < model.primitive_count && model.route_count < model.primitive_count)
      add(route.primitive);
  }
  if (!part.routes.empty()) return;
  for (int i = 0; i < model.primitive_count; ++i) add(i);
}

}  // namespace beltpick::pipeline
