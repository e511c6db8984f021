// Requirements: what a pose must show to be believed.
#pragma once

#include <array>

namespace beltpick {

// Shares need no tuning, and the distances they rest on follow from noise and template (result/scene.hpp). These hold
// for any part; where teaching found out that one must show more, its template says so.
struct Requirements {
  double support = 0.25;       // least share of the part that was measured where the pose says
  double coverage = 0.50;      // the same, of what could have been measured; shadows and highlights leave gaps
  double contradicted = 0.02;  // greatest share of what was measured there that lies off the surface
  double violated = 0.05;      // greatest share seen to be empty
  double sunk = 0.005;         // greatest share of the part under the belt: of 1,236 right poses none had any
  double unexplained = 0.03;   // greatest share of the part that the object itself hides
  double continued = 0.45;     // greatest share of the outline beyond which the object goes on
  int points = 60;             // least surface points in sight
  double residual = 0.35;      // greatest RMS to the surface, of the surface tolerance: far above what noise leaves,
                               // far below points spread over the tolerance

  friend bool operator==(const Requirements&, const Requirements&) = default;
};

// The shares by the names that they have in a template.
struct RequirementMember {
  const char* name;
  double Requirements::*value;
  bool least;  // a pose must show at least as much; else at most
};
inline constexpr std::array<RequirementMember, 8> kRequirementMembers{
    {{"support", &Requirements::support, true},
     {"coverage", &Requirements::coverage, true},
     {"contradicted", &Requirements::contradicted, false},
     {"violated", &Requirements::violated, false},
     {"sunk", &Requirements::sunk, false},
     {"unexplained", &Requirements::unexplained, false},
     {"continued", &Requirements::continued, false},
     {"residual", &Requirements::residual, false}}};

// What meets both.
constexpr Requirements stricter(const Requirements& a, const Requirements& b) {
  Requirements both = a;
  for (const RequirementMember& member : kRequirementMembers) {
    const double other = b.*member.value;
    if (member.least ? other > a.*member.value : other < a.*member.value) both.*member.value = other;
  }
  if (b.points > both.points) both.points = b.points;
  return both;
}

}  // namespace beltpick
