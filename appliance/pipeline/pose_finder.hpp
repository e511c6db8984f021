// PoseFinder: from one object to the pose of the part it is, or the reason why none is believed. Primitives, search,
// alignment and verification, in this order, with the memory one worker needs.
#pragma once

#include <array>
#include <span>

#include "base/arena.hpp"
#include "contract/limits.hpp"
#include "contract/locate_result.hpp"
#include "icp/align.hpp"
#include "pipeline/object_points.hpp"
#include "primitives/msac.hpp"
#include "result/drawing.hpp"
#include "result/evidence.hpp"
#include "result/scene.hpp"
#include "search/hypothesis_pool.hpp"

namespace beltpick::pipeline {

// A pose on trial.
struct Candidate {
  int model_index = 0;
  Hypothesis hypothesis;     // it came from
  double impression = -2.0;  // before all is drawn
  Alignment alignment;
  result::Evidence evidence;
  double strength = 0.0;  // what ranks it
};

// What became of one object.
struct Attempt {
  bool verified = false;
  Candidate best;                // meaningful where verified, or where a pose was withheld at verification
  Stage stage = Stage::kVerify;  // where it ended, and why, if not verified
  Error reason;
};

class PoseFinder {
 public:
  PoseFinder(Arena& arena, const Limits& limits);

  // Tries all models on the object. First what its primitives suggest; where that ends without a verified pose, every
  // view of the part; then the same on neighbourhoods within the object, which may be several parts. Same input, same
  // bits. `owner`: to which object each pixel belongs that is not explained yet; scene.labels holds all there was.
  Attempt find(const result::Scene& scene, ImageView<const std::uint16_t> owner, const Object& object,
               std::span<const PartModel> models, std::uint64_t seed);

  [[nodiscard]] std::span<const OrientedPoint> sample() const { return sample_.first(sample_count_); }

 private:
  static constexpr int kMaxCandidates = 40;
  static constexpr int kMaxPrimitivesFound = 4;
  static constexpr int kNoIndex = -1;

  struct Context {
    const result::Scene& scene;
    ImageView<const std::uint16_t> owner;
    const Object& object;
    std::span<const PartModel> models;
    std::uint64_t seed;
  };
  enum class Route : std::uint8_t { kPrimitives, kViews, kPlanes };

  Attempt try_routes(const Context& context);
  [[nodiscard]] Vec3f highest(const Context& context) const;
  Vec3f gather_round(const Vec3f& centre_mm, std::size_t all, float radius_mm);
  void collect(const Context& context, int model_index, Route route);
  void search_by_primitives(const Context& context, const PartModel& model, search::HypothesisPool& pool);
  void search_by_planes(const Context& context, const PartModel& model, search::HypothesisPool& pool);
  int find_primitives(const Context& context, const PartModel& model, std::span<Primitive> found);
  void shortlist(const Context& context, int model_index, Route route, search::HypothesisPool& pool);
  void align_fully(const Context& context, Candidate& candidate);
  void weigh(const Context& context, Candidate& candidate);
  void finish(const Context& context, Candidate& candidate);
  Attempt decide(const Context& context);
  bool explore(const Context& context, Candidate& champion);
  Result<void> trial(const Context& context, const Candidate& champion, int index);
  bool beats_rivals(const Context& context, const Candidate& champion, int index);
  void sort_by_strength();

  std::span<OrientedPoint> sample_;
  std::size_t sample_count_ = 0;
  std::span<OrientedPoint> pose_sample_;
  std::span<icp::OutlinePair> outline_;
  std::span<Hypothesis> pool_storage_;
  std::array<Candidate, kMaxCandidates> candidates_{};
  int candidate_count_ = 0;
  primitives::Finder finder_;
  result::Drawing drawing_;
};

}  // namespace beltpick::pipeline
