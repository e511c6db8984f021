// The verdict on a pose from its evidence: verified, or withheld with the reason.
#pragma once

#include "base/result.hpp"
#include "result/evidence.hpp"

namespace beltpick::result {

// What a pose must show. The same for every part and scene: shares need no tuning, and the distances they rest on
// follow from noise and template (scene.hpp).
struct Requirements {
  double support = 0.25;       // least share of the part that was measured where the pose says
  double coverage = 0.50;      // the same, of what could have been measured; shadows and highlights leave gaps
  double contradicted = 0.02;  // greatest share of what was measured there that lies off the surface
  double violated = 0.05;      // greatest share seen to be empty
  double sunk = 0.02;          // greatest share of the part under the belt
  double unexplained = 0.03;   // greatest share of the part that the object itself hides
  double continued = 0.45;     // greatest share of the outline beyond which the object goes on
  int points = 60;             // least surface points in sight
  double residual = 0.35;      // greatest RMS to the surface, of the surface tolerance: far above what noise leaves,
                               // far below points spread over the tolerance
};

// Ok, or the reason as it goes into result.json. Errors: kPartlyOutOfView, kFreeSpaceViolated, kCoverageTooLow,
// kResidualTooHigh, kObjectTooSmall.
Result<void> judge(const Evidence& evidence, double tolerance_mm, const Requirements& required);

// 0..1: how much speaks for the pose; orders rivals and the picks of one height.
double score(const Evidence& evidence);

}  // namespace beltpick::result
