// One search of one object: how much it tries, and what came of it.
#pragma once

#include <cstdint>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "base/units.hpp"
#include "contract/locate_result.hpp"
#include "contract/pose_difference.hpp"
#include "contract/result_codes.hpp"
#include "result/evidence.hpp"

namespace beltpick::pipeline {

// What a search tries, in the order in which it is worth while: each finds parts that those before it do not, at a
// higher price.
enum class Effort : std::uint8_t {
  kPrimitives,  // what the object's cylinders and spheres suggest
  kPlanes,      // what one face suggests
  kPieces,      // both, then every view, on the object and those next to it: shadows may have cut one part in pieces
  kViews,       // every view of the part
  kNeighbourhoods,        // by primitives, faces and views, what lies close together: an object may be several parts
  kJoined,                // as pieces, what found nothing and what found nothing next to it
  kJoinedNeighbourhoods,  // the same in neighbourhoods
};

// A pose on trial.
struct Candidate {
  int model_index = 0;
  Hypothesis hypothesis;     // it came from
  double impression = -2.0;  // before all is drawn
  Alignment alignment;
  result::Evidence evidence;
  double strength = 0.0;  // what ranks it
  bool finished = false;  // aligned as well as can be
  result::Region region;  // of the image in which it was drawn
};

// The part itself and its mirror image: what turns one into the other is no rotation, whose angle could be asked for.
inline bool same_hand(const Candidate& a, const Candidate& b) {
  return a.alignment.T_camera_part.rotation.determinant() * b.alignment.T_camera_part.rotation.determinant() > 0.0;
}

// Whether both poses are of the same part, not mirrored against each other, and differ less than that at every turn
// that leaves the part unchanged.
inline bool within(const Candidate& a, const Candidate& b, const PartModel& model, const PoseDifference& most) {
  if (a.model_index != b.model_index || !same_hand(a, b)) return false;
  const PoseDifference d = difference_modulo_symmetry(a.alignment.T_camera_part, b.alignment.T_camera_part, model);
  return d.translation_mm < most.translation_mm && d.rotation_rad < most.rotation_rad;
}

// Poses that differ less have found the same place.
inline constexpr double kSamePlaceShare = 0.012;  // of the diagonal
inline constexpr double kSameTurn_rad = 0.05;

inline bool same_place(const Candidate& a, const Candidate& b, const PartModel& model) {
  return within(a, b, model, {.translation_mm = kSamePlaceShare * model.diagonal_mm, .rotation_rad = kSameTurn_rad});
}

// A robot is promised a millimetre and a degree: of two poses that differ less than this either will do, if one of them
// is right. Alignments of one part that end further apart disagree, though they have found the same place.
inline constexpr double kSamePose_mm = 0.8;
inline constexpr double kSamePose_rad = rad_from_deg(0.8);

inline bool same_pose(const Candidate& a, const Candidate& b, const PartModel& model) {
  return within(a, b, model, {.translation_mm = kSamePose_mm, .rotation_rad = kSamePose_rad});
}

// What became of a search.
struct Attempt {
  bool verified = false;
  Candidate best;                // meaningful where verified, or where a pose was withheld at verification
  Stage stage = Stage::kVerify;  // where it ended, and why, if not verified
  Error reason;

  [[nodiscard]] bool failed() const { return reason.code != ResultCode::kOk; }
  [[nodiscard]] bool ambiguous() const { return reason.code == ResultCode::kPoseAmbiguous; }
  // Of attempts without a verified pose the one that came nearest to it tells most about the object.
  [[nodiscard]] bool nearer_than(const Attempt& other) const {
    if (!other.failed()) return true;
    return stage != other.stage ? stage > other.stage : best.strength > other.best.strength;
  }
};

}  // namespace beltpick::pipeline
