// Locator: from the objects of one range image to its parts in pick order.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/arena.hpp"
#include "contract/calibration.hpp"
#include "contract/limits.hpp"
#include "contract/locate_result.hpp"
#include "pipeline/model_store.hpp"
#include "pipeline/object_book.hpp"
#include "pipeline/pose_finder.hpp"
#include "pipeline/worker_team.hpp"
#include "result/grasp_choice.hpp"

namespace beltpick::pipeline {

struct LocateInput {
  RangeImage range;
  ImageView<const std::uint16_t> labels;
  std::span<const Segment> segments;
  std::optional<Plane> belt;
  Lens lens;                           // of the camera, or one fitted to a foreign cloud
  std::uint64_t seed = 1;              // of the capture
  std::optional<Vec3> projector_mm{};  // where the light stood, camera frame, where that is known
  std::span<const Pose<frame::Camera, frame::Gripper>> refused_grasps{};  // with which picks at this stop failed
};

// Views of the locator's memory, valid until its next locate().
struct LocateOutput {
  std::span<const LocatedPart> parts;  // in pick order: those that can be gripped first, top-most first
  std::span<const WithheldObject> withheld;
  std::span<const Candidate> candidates;  // of each of `parts`: how it was found
  std::span<const std::uint16_t> tried;   // segments that were searched, each by itself or as the first of several
  std::span<const double> object_ms;      // time spent on each of them
};

class Locator {
 public:
  // Takes the memory of `workers` pose workers and starts their threads (none for one worker, nor when measuring).
  Locator(Arena& arena, const Limits& limits, int workers = 1);

  // Finds every part of the loaded models, in rounds: what a found part explains is taken away, and what is left is
  // searched again, in ObjectBook's order.
  // Allocates nothing; the same bits for any number of workers.
  LocateOutput locate(const LocateInput& input, std::span<const PartModel> models);

  // Whom to tell every step of the search; null: nobody. Only for a locator of one worker.
  void set_trace(Trace* trace);

 private:
  struct Accepted {
    Candidate candidate;
    std::uint16_t segment = 0;
  };

  void search(const result::Scene& scene, std::span<const PartModel> models, std::span<const Object> objects,
              std::uint64_t seed);
  void add_time(std::uint16_t segment, double ms);
  void settle(const result::Scene& scene, std::span<const PartModel> models, std::span<const Object> objects);
  void reconsider_shadowed(const result::Scene& scene, std::span<const PartModel> models);
  [[nodiscard]] Result<void> fits_like_others(const result::Scene& scene, const Candidate& candidate) const;
  [[nodiscard]] bool found_ambiguous(const result::Scene& scene, std::span<const PartModel> models,
                                     const Candidate& candidate, std::size_t searched) const;
  void claim_ambiguous(const result::Scene& scene, std::span<const PartModel> models, std::span<const Object> objects);
  [[nodiscard]] std::optional<std::size_t> holder(const result::Scene& scene, std::span<const PartModel> models,
                                                  const Candidate& candidate) const;
  void contest(const result::Scene& scene, std::span<const PartModel> models, std::size_t held, Attempt& attempt);
  void rank(const result::Scene& scene, std::span<const PartModel> models);
  void choose_grasp(const result::Scene& scene, std::span<const PartModel> models, std::size_t index);
  void mark_contacts(std::span<const PartModel> models);
  LocatedPart describe(const result::Scene& scene, std::span<const PartModel> models, const Accepted& accepted);
  [[nodiscard]] bool touches_neighbour(const result::Scene& scene, const PartModel& model,
                                       const Candidate& candidate) const;

  ObjectBook book_;
  result::Drawing drawing_;
  result::ShadowMap shadows_;
  std::vector<PoseFinder> finders_;  // one a worker
  std::unique_ptr<WorkerTeam> team_;
  std::span<const Pose<frame::Camera, frame::Gripper>> refused_grasps_;  // of the present input
  std::span<Attempt> attempts_;                                          // by task of the round
  std::span<Accepted> accepted_;
  std::size_t accepted_count_ = 0;
  std::span<LocatedPart> parts_, ranked_;
  std::span<Candidate> part_candidates_;
  std::span<std::size_t> order_;
  std::span<result::Neighbour> neighbours_;  // of one part: the others
  std::span<WithheldObject> withheld_;
  std::size_t withheld_count_ = 0;
  std::span<double> attempt_ms_;  // by task of the round
  std::span<double> object_ms_;
  std::span<std::uint16_t> tried_;
  std::size_t tried_count_ = 0;
  Trace* trace_ = nullptr;
};

}  // namespace beltpick::pipeline
