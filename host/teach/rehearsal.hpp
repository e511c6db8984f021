// The rehearsal: the appliance's own pipeline on simulated views of what was taught, so that what to expect of a part
// is known before it lies on a belt: where it will be found, how exactly, how fast, in how much memory.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "teach/basin.hpp"
#include "teach/simulated_view.hpp"
#include "teach/teach.hpp"

namespace beltpick::teach {

enum class Outcome { kFound, kAmbiguous, kWithheld, kWrong };

struct RehearsedView {
  std::size_t resting = 0;  // index of the position
  Placement placement;
  PartPose truth;
  Outcome outcome = Outcome::kWithheld;
  std::string why;  // where withheld, as result.json says it
  // Of the pose found, the part's symmetry allowed for: rotation vector (rad) and shift (mm) of the centre of its box,
  // part frame.
  Eigen::Matrix<double, 6, 1> error = Eigen::Matrix<double, 6, 1>::Zero();
  double locate_ms = 0.0;  // on this machine, from the objects to the pose
};

struct Rehearsal {
  std::vector<RehearsedView> views;
  std::array<double, 6> rms_error{};    // by freedom (kFreedomNames), of the poses found
  std::array<double, 6> worst_error{};  // the same
  double median_ms = 0.0, slowest_ms = 0.0;
  std::size_t memory_bytes = 0;  // of the appliance with its default limits and one template
  int cut_wrong = 0;  // believed, but wrong, where the part was made to reach out of the image: see demands.hpp
  Basin basin;
  double noise_mm = 0.05;  // that was simulated

  [[nodiscard]] std::size_t count(Outcome outcome) const;
};

// Simulates `views` views over the resting positions, those of the likelier ones more often, locates the part in each
// and measures ICP's basin; fills taught.part.steps, routes and requirements, and warns of what went wrong. `mesh`: as
// it was taught. Errors: those of loading the template.
Result<Rehearsal> rehearse(Taught& taught, const Mesh& mesh, int views);

}  // namespace beltpick::teach
