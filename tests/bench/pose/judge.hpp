// Which of the poses found in a scene are right, and which parts were missed.
#pragma once

#include <string>
#include <vector>

#include "bench/pose/belt_camera.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::bench {

inline constexpr double kWrongMm = 1.0, kWrongDeg = 1.0;  // at the grasp
inline constexpr double kRecallVisible = 0.6;             // the share of a part that must be seen for a miss to count

// How far two poses of a part are apart at its grasp, modulo its symmetry.
struct GraspError {
  double mm = 0.0, deg = 0.0;
  [[nodiscard]] bool wrong() const { return mm > kWrongMm || deg > kWrongDeg; }
};

// At grasp `grasp_index` of the model, or, where none was reachable (-1), at that of all where it is largest.
GraspError grasp_error(const result::PartPose& found, const result::PartPose& truth, const PartModel& model,
                       int grasp_index);

// What an image shows of part i of the truth.
struct ShownPart {
  int pixels = 0, measured = 0;
  std::uint16_t segment = 0;  // that holds most of it; 0 without one

  [[nodiscard]] double measured_share() const { return pixels > 0 ? measured / static_cast<double>(pixels) : 0.0; }
};
ShownPart shown_part(const SeenScene& seen, const pipeline::Located& located, int i);

// A part that lay on the belt.
struct TruePartFate {
  std::string part;
  bool loaded = false;    // its template was
  double visible = 0.0;   // share of it in view of the camera and not hidden
  double measured = 0.0;  // share of it that was measured, too: the light reached it
  bool found = false;
  GraspError error;         // where found
  double surface_mm = 0.0;  // where found: RMS distance to the surface
  std::string why;          // where missed: what the product says of the segment that shows most of it
};

// A pose that was offered and is not true, or offered twice.
struct FalsePose {
  std::string part, nearest;  // what was claimed; the part of the truth that lies nearest
  GraspError error;           // against the nearest of the claimed kind; huge where there is none
  double score = 0.0, coverage = 0.0;
  bool duplicate = false;
};

struct SceneFate {
  std::vector<TruePartFate> parts;
  std::vector<FalsePose> false_poses;
  std::vector<double> found_object_ms;  // segment to verified pose, of the segments where a part was found
  double render_ms = 0.0, fold_ms = 0.0, decode_ms = 0.0, range_ms = 0.0, segment_ms = 0.0, locate_ms = 0.0;
};

SceneFate judge(const SeenScene& seen, const ScenePlan& plan, const PartPool& pool, const Machine& machine,
                const pipeline::Located& located);

}  // namespace beltpick::bench
