// PoseFinder: from one object to the pose of the part it is, or the reason why none is believed. Primitives, search,
// alignment and verification, in this order, with the memory one worker needs.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "base/arena.hpp"
#include "contract/limits.hpp"
#include "icp/align.hpp"
#include "pipeline/attempt.hpp"
#include "pipeline/icp_stages.hpp"
#include "pipeline/object_points.hpp"
#include "pipeline/trace.hpp"
#include "primitives/msac.hpp"
#include "result/drawing.hpp"
#include "result/scene.hpp"
#include "search/from_primitive.hpp"
#include "search/hypothesis_pool.hpp"

namespace beltpick::pipeline {

// Points of an object that its hypotheses are ranked by: the paper's number.
inline constexpr std::size_t kSearchSample = 100;
// Points of it that poses are aligned with before they are nearly right: the paper's, too.
inline constexpr std::size_t kAlignSample = 1000;
// And when they are.
inline constexpr std::size_t kFinalSample = 2500;

class PoseFinder {
 public:
  PoseFinder(Arena& arena, const Limits& limits);

  // Tries all models on the object with the effort asked for. Same input, same bits. `owner`: to which object each
  // pixel belongs that is not explained yet; scene.labels holds all there was.
  Attempt find(const result::Scene& scene, ImageView<const std::uint16_t> owner, const Object& object,
               std::span<const PartModel> models, std::uint64_t seed, Effort effort);

  [[nodiscard]] std::span<const OrientedPoint> sample() const { return sample_.first(sample_count_); }

  // Whom to tell every step; null: nobody.
  void set_trace(Trace* trace) { trace_ = trace; }

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

  // How a part is drawn: roughly to choose among poses, in full where a pose is to be believed.
  enum class Detail : std::uint8_t { kCoarse, kFine };

  // How an alignment looks at a part in sight.
  struct Look {
    double tolerances;   // how far, in tolerances of the surface
    std::size_t sample;  // at most so many points
    Detail detail;
  };
  static constexpr Look kOff{3.0, kAlignSample, Detail::kCoarse};   // first,
  static constexpr Look kNear{1.5, kAlignSample, Detail::kCoarse};  // then to compare,
  static constexpr Look kClose{1.5, kFinalSample, Detail::kFine};   // and at last

  // What a challenger must show beside the champion to be worth more work.
  struct Gate {
    double explained;   // at least this share of what the champion explains
    double seen_empty;  // of it, at most so much more than of the champion
  };
  // Of 100 poses that in the end rivalled the champion, or were stronger, none had less than
  static constexpr Gate kAligned{0.6, 0.25};   // (0.75, 0.17) with the object's sample,
  static constexpr Gate kInSight{0.75, 0.12};  // (0.82, 0.09) with all that is measured where it is in sight,
  static constexpr Gate kNearby{0.82, 0.05};   // (0.836, 0.02) and after another look, of the others two of three;
  static constexpr Gate kLosing{0.95, 0.05};   // and none of the weaker ones less than this (0.958, 0.03).

  Attempt try_route(const Context& context, Effort route);
  Attempt try_routes(const Context& context, std::span<const Effort> routes);
  Attempt try_neighbourhoods(const Context& context);
  void collect(const Context& context, int model_index, Effort route);
  [[nodiscard]] search::SearchInput search_input(const PartModel& model) const;
  void search_by_primitives(const Context& context, const PartModel& model, search::HypothesisPool& pool);
  void search_by_planes(const Context& context, const PartModel& model, search::HypothesisPool& pool);
  void tell_found(const Context& context, const PartModel& model, const Primitive& found);
  int find_primitives(const Context& context, const PartModel& model, std::span<Primitive> found);
  void shortlist(const Context& context, int model_index, Effort route, search::HypothesisPool& pool);
  std::size_t align_coarsely(const Context& context, int model_index, std::span<const Hypothesis> hypotheses,
                             std::span<Candidate> ends) const;
  void weigh_shortlist(const Context& context, Effort route);
  void align_shortlist(const Context& context, Effort route);
  [[nodiscard]] double best_impression() const;
  [[nodiscard]] static result::Impression impression(const Context& context, const Candidate& candidate);
  void align_fully(const Context& context, Candidate& candidate);
  void draw(const Context& context, const Candidate& candidate, Detail detail);
  void weigh(const Context& context, Candidate& candidate, Detail detail);
  void finish(const Context& context, Candidate& candidate);
  bool loses(const Context& context, const Candidate& champion, Candidate& other);
  bool keeps_up(const Context& context, const Candidate& champion, Candidate& other);
  bool finish_challenger(const Context& context, const Candidate& champion, Candidate& other);
  void finish_closely(const Context& context, Candidate& candidate);
  void weigh_closely(const Context& context, Candidate& candidate);
  bool align_in_sight(const Context& context, Candidate& candidate, const Look& look);
  [[nodiscard]] static bool far_behind(const Context& context, const Candidate& other, const Candidate& champion,
                                       const Gate& gate);
  Attempt decide(const Context& context);
  [[nodiscard]] static Result<void> plain_verdict(const Context& context, const Candidate& candidate);
  [[nodiscard]] static bool out_of_question(const Context& context, const Candidate& candidate);
  bool finish_if_worth_it(const Context& context, Candidate& candidate);
  void keep_support();
  [[nodiscard]] bool only_blemished(const Context& context, const Candidate& champion) const;
  bool challenge(const Context& context, Candidate& champion);
  void explore(const Context& context, const Candidate& champion);
  void add_lookalikes(const Context& context, const Candidate& champion);
  void add_challenger(const Context& context, const Candidate& champion, Candidate& other);
  Result<void> trial(const Context& context, const Candidate& champion, int index);
  bool beats_rivals(const Context& context, const Candidate& champion, int index);
  [[nodiscard]] bool beats_mirror_image(const Context& context, const Candidate& champion);
  Result<void> outline_agrees(const Context& context, const Candidate& champion);
  void sort_by_strength();

  std::span<OrientedPoint> sample_;
  std::size_t sample_count_ = 0;
  std::span<OrientedPoint> pose_sample_;
  std::size_t pose_sample_count_ = 0;
  std::array<OrientedPoint, 128> support_{};  // some of what the champion explains
  std::size_t support_count_ = 0;
  std::span<icp::OutlinePair> outline_;
  std::span<Hypothesis> pool_storage_;
  std::array<Candidate, kMaxCandidates> candidates_{};
  int candidate_count_ = 0;
  primitives::Finder finder_;
  struct Drawn {
    int model_index;
    Detail detail;
    result::PartPose T_camera_part;
  };
  result::Drawing drawing_;
  std::optional<Drawn> drawn_;  // what it shows
  result::BlemishFinder blemishes_;
  Trace* trace_ = nullptr;
};

}  // namespace beltpick::pipeline
