#include "pipeline/locate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/contest.hpp"
#include "pipeline/noise.hpp"
#include "pipeline/pick_order.hpp"
#include "pipeline/pose_hold.hpp"
#include "result/contact.hpp"
#include "result/verdict.hpp"

namespace beltpick::pipeline {
namespace {

// Every effort for whole objects and for fragments makes eleven rounds; parts lean on one another a few deep, and each
// round that uncovers one begins anew.
constexpr int kRounds = 28;
// Pieces of one part lie no farther apart than this share of its size.
constexpr double kFragmentReachShare = 0.12;
// A pose that explains a smaller share of the part may fit worse than others by this factor. Of 1,050 right ones of
// which less than 0.4 was measured 15 had twice the usual; a wrong one, that nothing else spoke against, 2.5 times.
constexpr double kHalfSeen = 0.5;
constexpr double kUnusualFit = 2.0;
// A gripper or a picked part may drag what lies nearer than this.
constexpr float kTouch_mm = 4.0F;

double smallest_view_mm2(std::span<const PartModel> models) {
  float least = std::numeric_limits<float>::max();
  for (const PartModel& model : models) {
    for (const PartView& view : model.views) least = std::min(least, view.seen_area);
  }
  return static_cast<double>(least);
}

double fragment_reach_mm(std::span<const PartModel> models) {
  double largest = 0.0;
  for (const PartModel& model : models) largest = std::max(largest, model.diagonal_mm);
  return kFragmentReachShare * largest;
}

// The pixels on every `step`-th row and column of the image, those that a part's surroundings may show: what lies so
// near the part, at no less than half its distance from the camera, appears so near the region in which it was drawn.
result::Region round_part(const Candidate& candidate, const PartModel& model, const result::Scene& scene,
                          double reach_mm, int step) {
  const double nearest_mm = std::max(1.0, 0.5 * (candidate.alignment.T_camera_part * model.centre_mm).z());
  const int reach_px = static_cast<int>(reach_mm * std::max(scene.lens.fx_px, scene.lens.fy_px) / nearest_mm) + 1;
  const auto on_lattice = [step](int px) { return std::max(0, px) / step * step; };
  const result::Region& drawn = candidate.region;
  return {on_lattice(drawn.row_min - reach_px), std::min(scene.labels.rows - 1, drawn.row_max + reach_px),
          on_lattice(drawn.col_min - reach_px), std::min(scene.labels.cols - 1, drawn.col_max + reach_px)};
}

}  // namespace

Locator::Locator(Arena& arena, const Limits& limits, int workers)
    : book_(arena, limits),
      drawing_(arena, limits),
      shadows_(arena, limits),
      attempts_(arena.take<Attempt>("locate: results", static_cast<std::size_t>(limits.segments))),
      accepted_(arena.take<Accepted>("locate: results", static_cast<std::size_t>(limits.parts))),
      parts_(arena.take<LocatedPart>("locate: results", static_cast<std::size_t>(limits.parts))),
      ranked_(arena.take<LocatedPart>("locate: results", static_cast<std::size_t>(limits.parts))),
      part_candidates_(arena.take<Candidate>("locate: results", static_cast<std::size_t>(limits.parts))),
      order_(arena.take<std::size_t>("locate: results", static_cast<std::size_t>(limits.parts))),
      neighbours_(arena.take<result::Neighbour>("locate: results", static_cast<std::size_t>(limits.parts))),
      withheld_(arena.take<WithheldObject>("locate: results", static_cast<std::size_t>(limits.segments))),
      attempt_ms_(arena.take<double>("locate: results", static_cast<std::size_t>(limits.segments))),
      object_ms_(arena.take<double>("locate: results", static_cast<std::size_t>(limits.segments))),
      tried_(arena.take<std::uint16_t>("locate: results", static_cast<std::size_t>(limits.segments))) {
  finders_.reserve(static_cast<std::size_t>(workers));
  for (int i = 0; i < workers; ++i) finders_.emplace_back(arena, limits);
  team_ = std::make_unique<WorkerTeam>(arena.measuring() ? 1 : workers);
}

LocateOutput Locator::locate(const LocateInput& input, std::span<const PartModel> models) {
  shadows_.cast(input.range, input.projector_mm, input.belt);
  result::Scene scene{input.range, input.labels, input.lens, input.belt, input.projector_mm, &shadows_};
  scene.noise_mm = measurement_noise_mm(input.range, input.labels);
  accepted_count_ = tried_count_ = 0;
  refused_grasps_ = input.refused_grasps;
  book_.begin(scene, input.segments, smallest_view_mm2(models));
  for (int round = 0; round < kRounds; ++round) {
    const auto objects = book_.next_round(scene, fragment_reach_mm(models));
    if (objects.empty()) break;
    search(scene, models, objects, input.seed);
    const std::size_t known = accepted_count_;
    settle(scene, models, objects);
    if (accepted_count_ > known) reconsider_shadowed(scene, models);
  }
  book_.next_round(scene, 0.0);
  const std::size_t withheld = book_.withheld(withheld_);
  rank(scene, models);
  return {ranked_.first(accepted_count_), withheld_.first(withheld), part_candidates_.first(accepted_count_),
          tried_.first(tried_count_), object_ms_.first(tried_count_)};
}

void Locator::set_trace(Trace* trace) {
  assert(trace == nullptr || finders_.size() == 1);
  trace_ = trace;
  for (PoseFinder& finder : finders_) finder.set_trace(trace);
}

void Locator::search(const result::Scene& scene, std::span<const PartModel> models, std::span<const Object> objects,
                     std::uint64_t seed) {
  auto job = [&](int worker, int task) {
    const auto index = static_cast<std::size_t>(task);
    const Stopwatch watch;
    const Object& object = objects[index];
    attempts_[index] = finders_[static_cast<std::size_t>(worker)].find(
        scene, book_.owner(), object, models, seed * 65536U + object.labels[0], book_.effort());
    attempt_ms_[index] = watch.elapsed_ms();
  };
  team_->run(static_cast<int>(objects.size()), job);
  for (std::size_t i = 0; i < objects.size(); ++i) add_time(objects[i].labels[0], attempt_ms_[i]);
}

void Locator::add_time(std::uint16_t segment, double ms) {
  const auto known = tried_.first(tried_count_);
  const auto at = static_cast<std::size_t>(std::find(known.begin(), known.end(), segment) - known.begin());
  if (at == tried_count_) {
    tried_[tried_count_] = segment;
    object_ms_[tried_count_++] = 0.0;
  }
  object_ms_[at] += ms;
}

// The strongest pose first; a weaker one that claims the same surface gives way.
void Locator::settle(const result::Scene& scene, std::span<const PartModel> models, std::span<const Object> objects) {
  for (std::size_t settled = 0; settled < objects.size(); ++settled) {
    std::size_t strongest = objects.size();
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (!attempts_[i].verified) continue;
      if (strongest == objects.size() || attempts_[i].best.strength > attempts_[strongest].best.strength) strongest = i;
    }
    if (strongest == objects.size()) break;
    Attempt& attempt = attempts_[strongest];
    attempt.verified = false;
    attempt.reason = failure(ResultCode::kDuplicatePose, "the pose overlaps one that is better supported").error();
    if (const auto held = holder(scene, models, attempt.best)) {
      contest(scene, models, *held, attempt);
      continue;
    }
    if (const auto fits = fits_like_others(scene, attempt.best); !fits) {
      attempt.reason = fits.error();
      continue;
    }
    if (found_ambiguous(scene, models, attempt.best, objects.size())) {
      attempt.reason = failure(ResultCode::kPoseAmbiguous,
                               "another search found another pose to fit as well; wait for a better view of the part")
                           .error();
      continue;
    }
    if (accepted_count_ == accepted_.size()) {
      attempt.reason =
          failure(ResultCode::kLimitExceeded, "expected at most %zu parts; raise limits.parts", accepted_.size())
              .error();
      continue;
    }
    accepted_[accepted_count_++] = {attempt.best, objects[strongest].labels[0]};
    const PartModel& model = models[static_cast<std::size_t>(attempt.best.model_index)];
    book_.explain(scene, model, attempt.best.alignment.T_camera_part, attempt.best.region);
    shadows_.add(model, attempt.best.alignment.T_camera_part);
    attempt.reason = {};
    attempt.stage = Stage::kRank;
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (attempts_[i].stage != Stage::kRank) book_.failed(objects[i], attempts_[i]);
    if (trace_ != nullptr) trace_->settled(objects[i], attempts_[i]);
  }
  claim_ambiguous(scene, models, objects);
}

// A part that was found since may have cast the shadow for whose sake a pose lacked coverage.
void Locator::reconsider_shadowed(const result::Scene& scene, std::span<const PartModel> models) {
  book_.reconsider([&](const Attempt& attempt) {
    if (attempt.reason.code != ResultCode::kCoverageTooLow) return false;
    const PartModel& model = models[static_cast<std::size_t>(attempt.best.model_index)];
    const result::PartPose& pose = attempt.best.alignment.T_camera_part;
    drawing_.draw(model.fine, pose, scene.lens);
    return result::judge(result::weigh(drawing_, model, pose, scene),
                         result::surface_tolerance_mm(scene, model.spacing_mm), model.required)
        .has_value();
  });
}

// Of a part that is mostly hidden little speaks against a wrong pose; but that little fits worse than parts that are
// seen well do, of the same template, in the same image. Where there are none, worse than the noise explains.
Result<void> Locator::fits_like_others(const result::Scene& scene, const Candidate& candidate) const {
  if (candidate.evidence.support >= kHalfSeen) return {};
  double usual_mm = 0.0;
  for (const Accepted& other : std::span(accepted_).first(accepted_count_)) {
    const result::Evidence& seen = other.candidate.evidence;
    if (other.candidate.model_index == candidate.model_index && seen.support >= kHalfSeen)
      usual_mm = std::max(usual_mm, seen.rms_mm);
  }
  if (usual_mm == 0.0) usual_mm = scene.noise_mm;
  if (candidate.evidence.rms_mm <= kUnusualFit * usual_mm) return {};
  return failure(ResultCode::kResidualTooHigh,
                 "mostly hidden, and what is seen of it lies %.3f mm (rms) off, where %.3f is usual; wait for a better "
                 "view of the part",
                 candidate.evidence.rms_mm, usual_mm);
}

// By a search before, or beside, the one it comes from, of whatever segment.
bool Locator::found_ambiguous(const result::Scene& scene, std::span<const PartModel> models, const Candidate& candidate,
                              std::size_t searched) const {
  const auto doubts = [&](const Attempt& other) { return doubted(candidate, other, scene, models); };
  const auto beside = attempts_.first(searched);
  return book_.any_ambiguous(doubts) ||
         std::any_of(beside.begin(), beside.end(), [&](const Attempt& a) { return a.ambiguous() && doubts(a); });
}

// A part is there, though its pose cannot be told: no other part may be made of its surface.
void Locator::claim_ambiguous(const result::Scene& scene, std::span<const PartModel> models,
                              std::span<const Object> objects) {
  for (const Object& object : objects) {
    const Attempt* attempt = book_.last_word(object);
    if (attempt == nullptr || !attempt->ambiguous() || holder(scene, models, attempt->best)) continue;
    const PartModel& model = models[static_cast<std::size_t>(attempt->best.model_index)];
    book_.explain(scene, model, attempt->best.alignment.T_camera_part, attempt->best.region);
  }
}

// Which accepted pose claims the object that this one claims.
std::optional<std::size_t> Locator::holder(const result::Scene& scene, std::span<const PartModel> models,
                                           const Candidate& candidate) const {
  for (std::size_t i = 0; i < accepted_count_; ++i) {
    if (contend(candidate, accepted_[i].candidate, scene, models).same_object()) return i;
  }
  return {};
}

// Two fragments of one object, each with a pose that was believed, and not the same: unless the picture prefers the one
// that was accepted, neither is. The surface stays taken.
void Locator::contest(const result::Scene& scene, std::span<const PartModel> models, std::size_t held,
                      Attempt& attempt) {
  const Candidate& first = accepted_[held].candidate;
  if (same_pose(first, attempt.best, models[static_cast<std::size_t>(first.model_index)])) return;
  if (result::prevails(contend(first, attempt.best, scene, models), first.evidence.support)) return;
  attempt.reason = failure(ResultCode::kPoseAmbiguous,
                           "pieces of one object fit different poses as well; wait for a better view of the part")
                       .error();
  accepted_[held] = accepted_[--accepted_count_];
}

void Locator::rank(const result::Scene& scene, std::span<const PartModel> models) {
  for (std::size_t i = 0; i < accepted_count_; ++i) parts_[i] = describe(scene, models, accepted_[i]);
  for (std::size_t i = 0; i < accepted_count_; ++i) choose_grasp(scene, models, i);
  mark_contacts(models);
  const auto order = order_.first(accepted_count_);
  order_picks(parts_.first(accepted_count_), order);
  for (std::size_t i = 0; i < accepted_count_; ++i) {
    part_candidates_[i] = accepted_[order[i]].candidate;
    ranked_[i] = parts_[order[i]];
  }
}

// A grasp may belong to another pose that looks the same: the part's symmetry then tells that one as well.
void Locator::choose_grasp(const result::Scene& scene, std::span<const PartModel> models, std::size_t index) {
  LocatedPart& part = parts_[index];
  const PartModel& model = models[static_cast<std::size_t>(part.template_index)];
  std::size_t others = 0;
  for (std::size_t i = 0; i < accepted_count_; ++i) {
    const Candidate& other = accepted_[i].candidate;
    if (i != index)
      neighbours_[others++] = {&models[static_cast<std::size_t>(other.model_index)], other.alignment.T_camera_part};
  }
  const auto choice =
      result::choose_grasp(model, part.T_camera_part, {scene, neighbours_.first(others), refused_grasps_});
  part.grasp_index = choice.index;
  if (choice.index < 0) part.not_offered = result::no_grasp_reason(choice, model.grasp_count);
  part.covariance = covariance_of_equivalent(choice.T_camera_part, part.T_camera_part, model, part.covariance);
  part.T_camera_part = choice.T_camera_part;
  spread_free_turns(part.covariance, part.T_camera_part, model);
}

// Contact is mutual: when either is picked, the pose of the other is no longer known.
void Locator::mark_contacts(std::span<const PartModel> models) {
  for (std::size_t i = 0; i < accepted_count_; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const LocatedPart& a = parts_[i];
      const LocatedPart& b = parts_[j];
      const result::Rival first{models[static_cast<std::size_t>(a.template_index)], a.T_camera_part};
      const result::Rival second{models[static_cast<std::size_t>(b.template_index)], b.T_camera_part};
      if (result::in_contact(first, second, kTouch_mm))
        parts_[i].touches_neighbour = parts_[j].touches_neighbour = true;
    }
  }
}

LocatedPart Locator::describe(const result::Scene& scene, std::span<const PartModel> models, const Accepted& accepted) {
  const Candidate& candidate = accepted.candidate;
  const PartModel& model = models[static_cast<std::size_t>(candidate.model_index)];
  LocatedPart part;
  part.template_index = candidate.model_index;
  part.segment = accepted.segment;
  part.status = model.symmetric() ? PoseStatus::kAmbiguous : PoseStatus::kVerified;
  part.T_camera_part = candidate.alignment.T_camera_part;
  part.rms_mm = candidate.evidence.rms_mm;
  part.coverage = candidate.evidence.coverage;
  part.free_space_share = candidate.evidence.violated;
  part.hidden_share = candidate.evidence.occluded;
  part.score = result::score(candidate.evidence);
  part.covariance = candidate.alignment.covariance;
  part.touches_neighbour = touches_neighbour(scene, model, candidate);
  drawing_.draw(model.fine, part.T_camera_part, scene.lens);
  part.top_mm = -std::numeric_limits<double>::max();
  for (const result::VisiblePoint& point : drawing_.visible()) {
    const double height = scene.belt ? scene.belt->height_mm(point.point_mm.cast<double>()) : -point.point_mm.z();
    part.top_mm = std::max(part.top_mm, height);
  }
  return part;
}

bool Locator::touches_neighbour(const result::Scene& scene, const PartModel& model, const Candidate& candidate) const {
  const auto T_part_camera = candidate.alignment.T_camera_part.inverse();
  const float own_mm =
      static_cast<float>(3.0 * result::surface_tolerance_mm(scene, model.spacing_mm)) + model.spacing_mm;
  constexpr int kStep = 3;
  int touching = 0;
  const result::Region near = round_part(candidate, model, scene, static_cast<double>(own_mm + kTouch_mm), kStep);
  for (int row = near.row_min; row <= near.row_max; row += kStep) {
    for (int col = near.col_min; col <= near.col_max; col += kStep) {
      if (scene.labels(row, col) == 0 || !scene.range.valid(row, col)) continue;
      const Vec3f at = (T_part_camera * scene.range.point_mm(row, col).cast<double>()).cast<float>();
      if (model.outside_box_mm(at) > own_mm + kTouch_mm) continue;
      const float distance = (model.nearest(at).point_mm - at).norm();
      touching += distance > own_mm && distance < own_mm + kTouch_mm ? 1 : 0;
    }
  }
  return touching > 10;
}

}  // namespace beltpick::pipeline
