// Demands: what a pose of the taught part must show beyond what a pose of any part must, found out on simulated views:
// in some of them the part reaches out of the image, and a pose that was believed there was wrong.
#pragma once

#include "contract/requirements.hpp"
#include "pipeline/pipeline.hpp"
#include "teach/simulated_view.hpp"

namespace beltpick::teach {

// The side on which the image ends.
enum class CutSide { kLeft, kRight, kTop, kBottom };

// The view with an image so much smaller that `share` of what was measured of the part lies inside. Refers to `view`.
pipeline::View cut(SimulatedView& view, double share, CutSide side);

class Demands {
 public:
  // A pose that was believed; `residual` is its RMS distance in surface tolerances.
  void believed(double support, double residual, bool wrong);

  // None lower than those of any part.
  [[nodiscard]] Requirements derived() const;
  [[nodiscard]] int wrong() const { return wrong_; }

 private:
  double wrong_support_ = 0.0;   // the greatest
  double right_residual_ = 0.0;  // the greatest
  int right_ = 0, wrong_ = 0;
};

}  // namespace beltpick::teach
