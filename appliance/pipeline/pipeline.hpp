// The data flow of one capture, on one page. Read this first.
//
//   frames --Measure--> range image --Segmenter--> objects --Locator--> parts in pick order
//
//   measure    decode    each frame is folded into per-pixel sums as it arrives; after the last: projector coordinates
//              range     rays of camera and projector meet in ordered points, with their predicted noise
//   segment    segment   the belt is taken away; what holds together is an object (the paper's equations 1, 2)
//   light      where it stood; that of a foreign cloud is found by its shadows (LightFinder)
//   locate     in rounds: a found part takes its surface away, and what is left is searched again
//     ObjectBook  what comes next: whole objects before fragments, little effort before much
//     PoseFinder  primitives  cylinders and spheres that the templates have, by MSAC (equations 3 to 5)
//                 search      Q (equation 6) over all poses that a primitive leaves free; in later rounds over all
//                             views of the part, and over all that one of its faces leaves free
//                 icp         the best dozens coarsely, the best few with the whole sample, point to plane
//                 result      drawn into the range image: is all there that should be seen, and nothing behind it?
//                             what the light did not reach (ShadowMap) tells nothing. A last alignment to everything
//                             measured in sight; no other pose as good, nor along the freedom held least (pose_hold)?
//     Locator     settle      of two poses that claim the same surface the better supported one stays
//                 rank        what can be gripped, highest first; the first taught grasp whose way in is clear
//
// Memory: every stage takes its share of the Arena when it is made, by the declared Limits alone: once with a measuring
// arena to learn the size, once for good. After that nothing is allocated, neither here nor in the pose workers.
// No stage keeps anything from one capture for the next; random choices are seeded by capture and segment, so that a
// capture gives the same bits again, with any number of workers.
#pragma once

#include <optional>
#include <span>

#include "base/arena.hpp"
#include "base/result.hpp"
#include "contract/gripper.hpp"
#include "contract/limits.hpp"
#include "contract/part_template.hpp"
#include "pipeline/light_fit.hpp"
#include "pipeline/locate.hpp"
#include "pipeline/model_store.hpp"
#include "segment/segmenter.hpp"

namespace beltpick::pipeline {

// A range image and who took it.
struct View {
  RangeImage range;
  Lens lens;                           // of the camera; of a foreign cloud the one that fit_lens() finds
  std::optional<Vec3> projector_mm{};  // where the light stood, camera frame; looked for in the shadows if not known
  std::uint64_t seed = 1;              // of the capture
};

// Views of the pipeline's memory, valid until the next locate().
struct Located {
  segment::Segmented objects;
  LocateOutput found;
  double segment_ms = 0.0;
  double locate_ms = 0.0;
};

// Everything after the range image. Measure (measure.hpp) stands before it where frames are to be decoded.
class Pipeline {
 public:
  Pipeline(Arena& arena, const Limits& limits, int workers = 1);

  // The templates to look for. Errors as ModelStore::load.
  Result<void> load(std::span<const PartTemplate> templates, const GripperShape& gripper = {});

  // Finds the loaded parts. Errors: kNoTemplate; kLimitExceeded where the image is larger than declared.
  Result<Located> locate(const View& view);

  // Whom locate() tells every step of the search; null: nobody. Only for a pipeline of one worker.
  void set_trace(Trace* trace) { locator_.set_trace(trace); }

  [[nodiscard]] std::span<const PartModel> models() const { return store_.models(); }

 private:
  Limits limits_;
  ModelStore store_;
  segment::Segmenter segmenter_;
  LightFinder light_finder_;
  Locator locator_;
};

// The camera frame's place of the projector's lens.
inline Vec3 projector_position_mm(const Calibration& calibration) {
  return calibration.T_projector_camera.inverse().translation_mm;
}

}  // namespace beltpick::pipeline
