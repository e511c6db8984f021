// The judging half of PoseFinder: of the candidates found, which one is believed.
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/contest.hpp"
#include "pipeline/lookalikes.hpp"
#include "pipeline/outline_pairs.hpp"
#include "pipeline/pose_finder.hpp"
#include "pipeline/pose_hold.hpp"
#include "result/rivalry.hpp"
#include "result/verdict.hpp"

namespace beltpick::pipeline {
namespace {

// How many of the best candidates are finished, and what share of the best one's strength they must have.
constexpr int kFinished = 4;
constexpr double kWorthFinishing = 0.5;
// What has less of both is not what lies there, however well it is finished: of 313 poses that were verified none had
// less support before, or but a few with next to no strength.
constexpr double kLeastSupport = 0.1;
constexpr double kLeastStrength = 0.02;

// What speaks against a pose so clearly that finishing will not have it believed.
struct Clearly {
  double violated, contradicted, continued;
};
// Of 616 poses that were verified none had more before than (0.21, 0.60, 0.12),
constexpr Clearly kAtFirst{0.35, 0.8, 0.3};
// nor than (0.012, 0.027, 0.11) once aligned in sight: three of five that failed had.
constexpr Clearly kOnceInSight{0.08, 0.2, 0.3};

bool refuted(const result::Evidence& e, const Clearly& by) {
  return e.violated > by.violated || e.contradicted > by.contradicted || e.continued > by.continued;
}
// A rival below this share of the champion's strength has lost already.
constexpr double kRivalStrength = 0.8;
// A part that only its outline holds may be off by so much, by the ends of it that are certain, each told to a pixel or
// two; they are looked for so many tolerances and millimetres away.
constexpr double kMostAsked_mm = 0.6;
constexpr double kMostAsked_px = 2.0;
constexpr double kAskedReaches = 3.0;
constexpr double kAskedBeyond_mm = 5.0;
// ... and where it shows less of itself than this share of what it usually does, so much of it must lie inside the
// image: the edge of that cuts the outline, and any flat face that goes on beyond may be the part's.
constexpr double kShowsLittle = 0.5;
constexpr double kOutlineInView = 0.9;
constexpr int kFinishedRivals = 8;

// Of each model, how many poses are tried that put nearly the same surface there.
constexpr std::size_t kLookalikes = 3;
constexpr std::size_t kMirrorImages = 4;

// What a pose explains of the picture, less what speaks against it. Not a share of what the part would show: of two
// poses that explain the same surface the one that hides less of the part in shadow would lose by that alone. By area:
// the points of different templates stand differently close.
double explained_mm2(const Candidate& candidate, std::span<const PartModel> models) {
  if (candidate.evidence.support <= 0.0) return 0.0;
  const double spacing_mm = models[static_cast<std::size_t>(candidate.model_index)].spacing_mm;
  return candidate.strength * candidate.evidence.matched / candidate.evidence.support * spacing_mm * spacing_mm;
}

// What the part shows, across the line of sight, from one direction and another.
double usual_view_mm2(const PartModel& model) {
  double sum = 0.0;
  for (const PartView& view : model.views) sum += static_cast<double>(view.seen_area);
  return sum / PartModel::kViews;
}

bool shows_little(const Candidate& candidate, const PartModel& model) {
  return candidate.evidence.matched * model.spacing_mm * model.spacing_mm < kShowsLittle * usual_view_mm2(model);
}

// Whether a pose explains so little of what another one does that it need not be compared with it.
bool hopeless(const Candidate& rival, const Candidate& champion, std::span<const PartModel> models) {
  return explained_mm2(rival, models) < kRivalStrength * explained_mm2(champion, models);
}

// A part that its mirror image covers to this share has no handedness worth telling.
constexpr double kSameSurfaceShare = 0.98;

// Along a freedom that is not held firmly other poses are looked for, so far away on the part's rim.
constexpr std::array<double, 6> kExplored_mm{2.5, -2.5, 6.0, -6.0, 14.0, -14.0};

// Whether the part in both poses, one of them mirrored, is the same surface: it has a plane of symmetry there.
bool same_surface(const PartModel& model, const result::PartPose& mirrored, const result::PartPose& pose,
                  float tolerance_mm) {
  const auto across = pose.inverse() * mirrored;
  const Eigen::Matrix3f rotation = across.rotation.cast<float>();
  const Vec3f translation = across.translation_mm.cast<float>();
  std::size_t on_surface = 0;
  for (const PointBlock& block : model.scattered) {
    for (std::size_t k = 0; k < PointBlock::kSize; ++k) {
      const Vec3f at = rotation * Vec3f(block.x[k], block.y[k], block.z[k]) + translation;
      const OrientedPoint& nearest = model.nearest(at);
      on_surface += std::abs(nearest.normal.dot(at - nearest.point_mm)) < tolerance_mm &&
                            (at - nearest.point_mm).norm() < 2.0F * model.spacing_mm + tolerance_mm
                        ? 1
                        : 0;
    }
  }
  return static_cast<double>(on_surface) >=
         kSameSurfaceShare * static_cast<double>(model.scattered.size() * PointBlock::kSize);
}

}  // namespace

void PoseFinder::sort_by_strength() {
  const auto first = candidates_.begin();
  const auto stronger = [](const Candidate& a, const Candidate& b) { return a.strength > b.strength; };
  // A stable sort of few by insertion: std::stable_sort takes its buffer from the heap.
  for (auto next = first; next != first + candidate_count_; ++next) {
    std::rotate(std::upper_bound(first, next, *next, stronger), next, next + 1);
  }
}

// The strongest candidates are finished and judged in turn, until one is verified; what the strongest lacked is the
// reason where none is.
Attempt PoseFinder::decide(const Context& context) {
  Attempt attempt;
  if (candidate_count_ == 0) {
    attempt.stage = Stage::kSearch;
    attempt.reason =
        failure(ResultCode::kNoHypothesis, "no template fits; a foreign object, or a part not taught").error();
    return attempt;
  }
  sort_by_strength();
  const double least_strength = kWorthFinishing * candidates_.front().strength;
  int finished = 0;
  for (int i = 0; i < candidate_count_ && finished < kFinished; ++i) {
    Candidate& candidate = candidates_[static_cast<std::size_t>(i)];
    if (candidate.strength < least_strength) break;
    Candidate champion = candidate;
    const bool first = finished++ == 0;
    if (out_of_question(context, candidate) || !finish_if_worth_it(context, champion)) {
      if (first) attempt.best = champion, attempt.reason = plain_verdict(context, champion).error();
      continue;
    }
    candidate = champion;  // which those after it have to reckon with
    keep_support();
    auto verdict = trial(context, champion, i);
    auto outline = verdict ? outline_agrees(context, champion) : verdict;  // while it is drawn
    if ((verdict || only_blemished(context, champion)) && challenge(context, champion)) {
      verdict = trial(context, champion, kNoIndex);
      if (verdict) outline = outline_agrees(context, champion);
    }
    if (verdict) verdict = outline;
    if (verdict && !beats_mirror_image(context, champion)) {
      verdict = failure(ResultCode::kPoseAmbiguous,
                        "the part's mirror image fits as well; wait for a view of what tells them apart");
    }
    if (trace_ != nullptr) trace_->judged(champion, verdict);
    if (verdict || first || verdict.error().code == ResultCode::kPoseAmbiguous) {
      attempt.best = champion;
      attempt.verified = verdict.has_value();
      if (!verdict) attempt.reason = verdict.error();
    }
    if (verdict || verdict.error().code == ResultCode::kPoseAmbiguous) break;
  }
  return attempt;
}

Result<void> PoseFinder::plain_verdict(const Context& context, const Candidate& candidate) {
  const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
  return result::judge(candidate.evidence, result::surface_tolerance_mm(context.scene, model.spacing_mm),
                       model.required);
}

// Explains so little, or that against so much, that no finishing will have it believed.
bool PoseFinder::out_of_question(const Context& context, const Candidate& candidate) {
  const bool next_to_nothing = candidate.strength < kLeastStrength && candidate.evidence.support < kLeastSupport;
  return (next_to_nothing || refuted(candidate.evidence, kAtFirst)) && !plain_verdict(context, candidate);
}

// Returns whether it was finished: aligned in sight, most of what is not there shows.
bool PoseFinder::finish_if_worth_it(const Context& context, Candidate& candidate) {
  if (!align_in_sight(context, candidate, kOff)) return true;  // trial() tells that too little was measured
  weigh(context, candidate, Detail::kCoarse);
  if (refuted(candidate.evidence, kOnceInSight) && !plain_verdict(context, candidate)) return false;
  finish_closely(context, candidate);
  return true;
}

// What the pose just finished explains, of whatever segment: the object's own sample may be a fragment that tells less.
void PoseFinder::keep_support() {
  support_count_ = std::min(pose_sample_count_, support_.size());
  for (std::size_t i = 0; i < support_count_; ++i) support_[i] = pose_sample_[i * pose_sample_count_ / support_count_];
}

// Perhaps the part, but turned.
bool PoseFinder::only_blemished(const Context& context, const Candidate& champion) const {
  if (!champion.evidence.blemishes.any()) return false;
  result::Evidence otherwise = champion.evidence;
  otherwise.blemishes = {};
  const PartModel& model = context.models[static_cast<std::size_t>(champion.model_index)];
  return result::judge(otherwise, result::surface_tolerance_mm(context.scene, model.spacing_mm), model.required)
      .has_value();
}

// Looks for other poses that the search may not have met. Those found become candidates; the strongest of all is the
// champion. Returns whether any was found.
bool PoseFinder::challenge(const Context& context, Candidate& champion) {
  const int before = candidate_count_;
  explore(context, champion);
  add_lookalikes(context, champion);
  for (int i = before; i < candidate_count_; ++i) {
    const Candidate& other = candidates_[static_cast<std::size_t>(i)];
    const bool clean = !other.evidence.blemishes.any();
    const bool cleaner = champion.evidence.blemishes.any() && other.strength > kRivalStrength * champion.strength;
    if (clean && (cleaner || other.strength > champion.strength)) champion = other;
  }
  return candidate_count_ > before;
}

// Along the freedom that is held least: few points may hold it, and wrongly.
void PoseFinder::explore(const Context& context, const Candidate& champion) {
  const PartModel& model = context.models[static_cast<std::size_t>(champion.model_index)];
  const auto freedom = loosest_freedom(champion.alignment, model);
  if (!freedom) return;
  for (const double rim_mm : kExplored_mm) {
    Candidate other = champion;
    other.alignment.T_camera_part = moved(champion.alignment.T_camera_part, rim_mm * *freedom, model);
    add_challenger(context, champion, other);
  }
}

void PoseFinder::add_lookalikes(const Context& context, const Candidate& champion) {
  const PartModel& model = context.models[static_cast<std::size_t>(champion.model_index)];
  const std::span<const OrientedPoint> support(support_);
  const search::SearchSample sample(support.first(support_count_));
  const result::PartPose& pose = champion.alignment.T_camera_part;
  for (int i = 0; i < static_cast<int>(context.models.size()); ++i) {
    const PartModel& other_model = context.models[static_cast<std::size_t>(i)];
    search::HypothesisPool pool(pool_storage_);
    i == champion.model_index ? offer_turns(model, pose, sample, pool)
                              : offer_other(model, pose, other_model, sample, pool);
    std::array<Hypothesis, kLookalikes + 1> found;  // the champion itself is often among the turns
    const std::size_t count =
        pool.take_distinct(other_model, 0.04 * other_model.diagonal_mm, rad_from_deg(12.0), found);
    for (std::size_t k = 0; k < count; ++k) {
      Candidate other;
      other.model_index = i;
      other.hypothesis = found[k];
      other.alignment.T_camera_part = found[k].T_camera_part;
      add_challenger(context, champion, other);
    }
  }
}

// Whether a pose, not finished, explains far fewer of the measured pixels than the champion, or puts more of the part
// where nothing is. Both are asked about the same pixels: what of either lies in shadow counts for neither.
bool PoseFinder::far_behind(const Context& context, const Candidate& other, const Candidate& champion,
                            const Gate& gate) {
  if (impression(context, other).seen_empty > impression(context, champion).seen_empty + gate.seen_empty) return true;
  const result::Rivalry rivalry = contend(champion, other, context.scene, context.models);
  return rivalry.both + rivalry.only_second < gate.explained * (rivalry.both + rivalry.only_first);
}

// Whether a pose that was aligned in sight is the weaker one and stays behind when looked at once more.
bool PoseFinder::loses(const Context& context, const Candidate& champion, Candidate& other) {
  weigh(context, other, Detail::kCoarse);
  if (other.strength >= champion.strength || !far_behind(context, other, champion, kLosing)) return false;
  return !align_in_sight(context, other, kNear) || far_behind(context, other, champion, kLosing);
}

// Whether a pose that was aligned is still to be reckoned with when it is looked at ever closer: it has neither fallen
// too far behind nor met the champion.
bool PoseFinder::keeps_up(const Context& context, const Candidate& champion, Candidate& other) {
  if (far_behind(context, other, champion, kAligned)) return false;
  if (!align_in_sight(context, other, kOff) || far_behind(context, other, champion, kInSight)) return false;
  if (!align_in_sight(context, other, kNear) || far_behind(context, other, champion, kNearby)) return false;
  if (same_pose(other, champion, context.models[static_cast<std::size_t>(champion.model_index)])) return false;
  return !loses(context, champion, other);
}

// Returns whether it was worth it.
bool PoseFinder::finish_challenger(const Context& context, const Candidate& champion, Candidate& other) {
  if (!keeps_up(context, champion, other)) return false;
  finish_closely(context, other);
  return true;
}

// Aligned and finished, the other becomes a candidate, unless it ends where the champion is. Beside a champion with
// blemishes none is left out: a cleaner pose may take its place though it explains less.
void PoseFinder::add_challenger(const Context& context, const Candidate& champion, Candidate& other) {
  if (candidate_count_ == kMaxCandidates) return;
  const PartModel& model = context.models[static_cast<std::size_t>(champion.model_index)];
  if (same_pose(other, champion, model)) return;
  align_fully(context, other);
  if (same_pose(other, champion, model)) return;
  if (champion.evidence.blemishes.any()) {
    finish(context, other);
  } else if (!finish_challenger(context, champion, other)) {
    return;
  }
  if (same_pose(other, champion, model)) return;
  candidates_[static_cast<std::size_t>(candidate_count_++)] = other;
}

Result<void> PoseFinder::trial(const Context& context, const Candidate& champion, int index) {
  const auto verdict = plain_verdict(context, champion);
  if (!verdict) return verdict;
  if (!champion.finished) {
    return failure(
        ResultCode::kCoverageTooLow,
        "too little was measured where the part is in sight to align it; hidden, shiny, or a foreign object");
  }
  const PartModel& model = context.models[static_cast<std::size_t>(champion.model_index)];
  if (!determined(champion.alignment, model)) {
    return failure(ResultCode::kPoseAmbiguous,
                   "what is in view lets the part slide or turn; wait for a better view of it");
  }
  if (!beats_rivals(context, champion, index)) {
    return failure(ResultCode::kPoseAmbiguous, "another pose fits as well; wait for a better view of the part");
  }
  return {};
}

bool PoseFinder::beats_rivals(const Context& context, const Candidate& champion, int index) {
  const auto& model = context.models[static_cast<std::size_t>(champion.model_index)];
  int finished = 0;
  for (int i = 0; i < candidate_count_ && finished < kFinishedRivals; ++i) {
    Candidate rival = candidates_[static_cast<std::size_t>(i)];
    if (i == index || hopeless(rival, champion, context.models)) continue;
    // Small differences decide: both must be aligned as well as can be.
    if (!rival.finished) {
      if (same_place(champion, rival, model)) continue;  // and would end where the champion did
      if (!finish_challenger(context, champion, rival)) continue;
    }
    ++finished;
    if (hopeless(rival, champion, context.models) || same_pose(champion, rival, model)) continue;
    const auto& other = context.models[static_cast<std::size_t>(rival.model_index)];
    const result::Rivalry rivalry = result::compare({model, champion.alignment.T_camera_part},
                                                    {other, rival.alignment.T_camera_part}, context.scene, 1);
    if (trace_ != nullptr) trace_->compared(champion, rival, rivalry);
    if (rivalry.same_object() && !stands(champion, rival, rivalry)) return false;
  }
  return true;
}

// A part's mirror twin need not be loaded to lie on the belt: where the mirrored part explains what was measured as
// well, what tells them apart is hidden.
bool PoseFinder::beats_mirror_image(const Context& context, const Candidate& champion) {
  const auto& model = context.models[static_cast<std::size_t>(champion.model_index)];
  const auto tolerance_mm = static_cast<float>(2.0 * result::surface_tolerance_mm(context.scene, model.spacing_mm));
  const result::PartPose& pose = champion.alignment.T_camera_part;
  search::HypothesisPool pool(pool_storage_);
  offer_mirrored(model, pose, search::SearchSample(std::span<const OrientedPoint>(support_).first(support_count_)),
                 pool);
  std::array<Hypothesis, kMirrorImages> found;
  const std::size_t count = pool.take_distinct(model, 0.04 * model.diagonal_mm, rad_from_deg(12.0), found);
  for (const Hypothesis& hypothesis : std::span(found).first(count)) {
    Candidate rival;
    rival.model_index = champion.model_index;
    rival.hypothesis = hypothesis;
    rival.alignment.T_camera_part = hypothesis.T_camera_part;
    align_fully(context, rival);
    const auto is_the_part = [&] { return same_surface(model, rival.alignment.T_camera_part, pose, tolerance_mm); };
    if (is_the_part() || !keeps_up(context, champion, rival)) continue;
    align_in_sight(context, rival, kClose);
    if (is_the_part()) continue;
    const result::Rivalry rivalry =
        result::compare({model, pose}, {model, rival.alignment.T_camera_part}, context.scene, 1);
    if (trace_ != nullptr) trace_->compared(champion, rival, rivalry);
    if (!rivalry.same_object() || result::prevails(rivalry, champion.evidence.support)) continue;
    weigh_closely(context, rival);
    if (!hopeless(rival, champion, context.models) && !rival.evidence.blemishes.any()) return false;
  }
  return true;
}

// Asks the ends of the outline that are certain; those that may be the edges of shadows are left out.
Result<void> PoseFinder::outline_agrees(const Context& context, const Candidate& champion) {
  const PartModel& model = context.models[static_cast<std::size_t>(champion.model_index)];
  if (!held_by_outline(champion.alignment, model)) return {};
  if (champion.evidence.in_view < kOutlineInView && shows_little(champion, model)) {
    return failure(ResultCode::kPartlyOutOfView,
                   "little but its outline holds the part, and %.0f %% of it lies beyond the image's edge; it is seen "
                   "whole on its next lap",
                   100.0 * (1.0 - champion.evidence.in_view));
  }
  const result::PartPose& pose = champion.alignment.T_camera_part;
  draw(context, champion, Detail::kFine);
  const double reach_mm =
      kAskedReaches * result::surface_tolerance_mm(context.scene, model.spacing_mm) + kAskedBeyond_mm;
  const std::size_t ends =
      pair_outline(drawing_, pose, context.scene, model.spacing_mm, reach_mm,
                   result::free_space_tolerance_mm(context.scene, model.spacing_mm), outline_, Borders::kCertain);
  const double asked_mm = asked_shift_mm(champion.alignment, model, outline_.first(ends));

  const double pixel_mm = (pose * model.centre_mm).z() / context.scene.lens.fx_px;
  if (asked_mm < std::max(kMostAsked_mm, kMostAsked_px * pixel_mm)) return {};
  return failure(ResultCode::kPoseAmbiguous,
                 "the part may slide, and its edges that are certain ask for %.1f mm; wait for a better view of them",
                 asked_mm);
}

}  // namespace beltpick::pipeline
