#include "explain/checks.hpp"

namespace beltpick::explain {

std::vector<Check> checks_of(const result::Evidence& e, double tolerance_mm, const Requirements& required) {
  return {
      {"points", "surface points in sight", static_cast<double>(e.points), static_cast<double>(required.points), true,
       ""},
      {"free_space_violated", "of the surface in sight, seen to be empty", e.violated, required.violated, false, "%"},
      {"seen_through_mm2", "of the surface in one piece, seen through", e.blemishes.seen_through_mm2, 0.0, false,
       "mm2"},
      {"filled_mm2", "of a hole of the part, found filled", e.blemishes.filled_mm2, 0.0, false, "mm2"},
      {"under_belt", "of the whole surface, under the belt", e.sunk, required.sunk, false, "%"},
      {"contradicted", "of what was measured there, off the surface", e.contradicted, required.contradicted, false,
       "%"},
      {"unexplained", "of the pose, hidden by the object itself", e.unexplained, required.unexplained, false, "%"},
      {"coverage", "of what should be visible, measured there", e.coverage, required.coverage, true, "%"},
      {"support", "of the part's side seen, measured there", e.support, required.support, true, "%"},
      {"outline_continued", "of the outline, beyond which the object goes on", e.continued, required.continued, false,
       "%"},
      {"rms_mm", "RMS to the surface", e.rms_mm, required.residual * tolerance_mm, false, "mm"},
  };
}

}  // namespace beltpick::explain
