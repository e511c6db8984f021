#include "pipeline/pose_finder.hpp"

#include <algorithm>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/contest.hpp"
#include "pipeline/neighbourhood.hpp"
#include "pipeline/outline_pairs.hpp"
#include "search/from_primitive.hpp"
#include "search/views.hpp"

namespace beltpick::pipeline {
namespace {

constexpr std::size_t kOutlinePairs = 4096;
// Which step ends the last alignment, as a share of how far it looks.
constexpr double kSettled = 1e-3;
constexpr std::size_t kPoolSize = 400;
constexpr std::size_t kMaxShortlist = 80;

// How many hypotheses are aligned coarsely, and how many of those with the whole sample and drawn.
struct Breadth {
  std::size_t shortlist;
  std::size_t full;
};
constexpr Breadth kByPrimitives{40, 6};
constexpr Breadth kByViews{kMaxShortlist, 10};  // nothing tells them which way the part lies
constexpr std::size_t kLeastSample = 60;
// What is worth a full alignment: of the best first impression among all models, at least this share. Poses that end
// nearly as strong as the strongest have made at least 0.7 of it, four of five others less than 0.1. Where no
// impression is good, all are tried.
constexpr double kLeastImpression = 0.4;
constexpr double kGoodImpression = 0.2;
// A pose aligned with the whole sample that is seen to be empty there: of 313 poses that were verified none had made
// less than -0.1, of those that failed seven of ten do.
constexpr double kBadImpression = -0.25;

bool impresses(const Candidate& aligned, double best) {
  return aligned.impression > kBadImpression &&
         (best <= kGoodImpression || aligned.impression >= kLeastImpression * best);
}

double strength(const result::Evidence& e) {
  return e.support * (1.0 - e.contradicted) * std::max(0.0, 1.0 - 4.0 * e.violated) * (1.0 - 0.5 * e.continued) *
         std::max(0.0, 1.0 - 2.0 * e.unexplained) * std::max(0.0, 1.0 - 4.0 * e.sunk);
}

// Where to look within an object that is none of the parts as a whole: round its highest point and those far from it.
constexpr int kNeighbourhoods = 3;
constexpr double kNeighbourhoodShare = 0.4;  // of the largest part's diagonal

constexpr std::array<Effort, 3> kRoutes{Effort::kPrimitives, Effort::kPlanes, Effort::kViews};

double largest_diagonal_mm(std::span<const PartModel> models) {
  double largest = 0.0;
  for (const PartModel& model : models) largest = std::max(largest, model.diagonal_mm);
  return largest;
}

// Of an object's points, what a primitive must hold.
constexpr double kLeastCurvedShare = 0.12;
constexpr double kLeastFaceShare = 0.2;

primitives::PrimitiveQuery query_for(const result::Scene& scene, PrimitiveKind kind, double least_share) {
  primitives::PrimitiveQuery query;
  query.kind = kind;
  query.sigma_mm = std::max(scene.noise_mm, 0.1);
  query.min_share = least_share;
  query.max_trials = 400;
  return query;
}

}  // namespace

PoseFinder::PoseFinder(Arena& arena, const Limits& limits)
    : sample_(arena.take<OrientedPoint>("search: object sample", static_cast<std::size_t>(limits.object_points))),
      pose_sample_(arena.take<OrientedPoint>("search: object sample", static_cast<std::size_t>(limits.object_points))),
      outline_(arena.take<icp::OutlinePair>("icp: outline", kOutlinePairs)),
      pool_storage_(arena.take<Hypothesis>("search: hypotheses",
                                           std::min(kPoolSize, static_cast<std::size_t>(limits.hypotheses)))),
      finder_(arena, limits.object_points),
      drawing_(arena, limits),
      blemishes_(arena, limits) {}

Attempt PoseFinder::find(const result::Scene& scene, ImageView<const std::uint16_t> owner, const Object& object,
                         std::span<const PartModel> models, std::uint64_t seed, Effort effort) {
  const Context context{scene, owner, object, models, seed};
  drawn_.reset();
  sample_count_ = sample_object(scene.range, owner, object, kAlignSample, seed, sample_);
  if (sample_count_ < kLeastSample) {
    Attempt attempt;
    attempt.stage = Stage::kSegment;
    attempt.reason = failure(ResultCode::kObjectTooSmall,
                             "%zu points with a normal, expected at least %zu; dirt, or a "
                             "part mostly hidden",
                             sample_count_, kLeastSample)
                         .error();
    return attempt;
  }
  switch (effort) {
    case Effort::kNeighbourhoods:
    case Effort::kJoinedNeighbourhoods:
      return try_neighbourhoods(context);
    case Effort::kPieces:
    case Effort::kJoined:
      return try_routes(context, kRoutes);
    default:
      return try_route(context, effort);
  }
}

// Parts that were not parted pull a pose between them: what lies close together belongs to one, and the one on top is
// in sight.
Attempt PoseFinder::try_neighbourhoods(const Context& context) {
  const std::size_t all = sample_count_;
  const auto radius_mm = static_cast<float>(kNeighbourhoodShare * largest_diagonal_mm(context.models));
  Attempt nearest;
  Vec3f start = highest_point_mm(sample(), context.scene.belt);
  for (int i = 0; i < kNeighbourhoods; ++i) {
    const Neighbourhood neighbourhood = gather_round(sample_.first(all), start, radius_mm);
    sample_count_ = neighbourhood.count;
    if (sample_count_ == all) break;  // the object is no larger than that
    if (sample_count_ >= kLeastSample) {
      const Attempt part = try_routes(context, kRoutes);
      if (part.verified) return part;
      if (part.nearer_than(nearest)) nearest = part;
    }
    start = neighbourhood.farthest_mm;
  }
  return nearest;
}

// The first route that ends with a verified pose, unless one before it has raised a doubt; or the one that came
// nearest.
Attempt PoseFinder::try_routes(const Context& context, std::span<const Effort> routes) {
  Attempt nearest, doubt;
  for (const Effort route : routes) {
    const Attempt attempt = try_route(context, route);
    if (attempt.verified)
      return doubt.ambiguous() && doubted(attempt.best, doubt, context.scene, context.models) ? doubt : attempt;
    if (attempt.ambiguous() && attempt.nearer_than(doubt)) doubt = attempt;
    if (attempt.nearer_than(nearest)) nearest = attempt;
  }
  return nearest;
}

Attempt PoseFinder::try_route(const Context& context, Effort route) {
  if (trace_ != nullptr)
    trace_->begins({context.scene, context.owner, context.object, context.models, sample(), route});
  candidate_count_ = 0;
  for (int i = 0; i < static_cast<int>(context.models.size()); ++i) collect(context, i, route);
  weigh_shortlist(context, route);
  const Attempt attempt = decide(context);
  if (trace_ != nullptr) trace_->ends(attempt);
  return attempt;
}

void PoseFinder::collect(const Context& context, int model_index, Effort route) {
  const PartModel& model = context.models[static_cast<std::size_t>(model_index)];
  search::HypothesisPool pool(pool_storage_);
  if (route == Effort::kPrimitives) {
    search_by_primitives(context, model, pool);
  } else if (route == Effort::kPlanes) {
    search_by_planes(context, model, pool);
  } else {
    search::search_views(search_input(model), pool);
  }
  shortlist(context, model_index, route, pool);
}

search::SearchInput PoseFinder::search_input(const PartModel& model) const {
  const search::SearchSample sample(this->sample().first(std::min(sample_count_, kSearchSample)));
  return {model, sample, static_cast<float>(coarse_radius_mm(model))};
}

void PoseFinder::search_by_primitives(const Context& context, const PartModel& model, search::HypothesisPool& pool) {
  std::array<Primitive, kMaxPrimitivesFound> found;
  const int count = find_primitives(context, model, found);
  const search::SearchInput input = search_input(model);
  for (const Primitive& primitive : std::span(found).first(static_cast<std::size_t>(count))) {
    tell_found(context, model, primitive);
    for (const Primitive& taught : model.taught()) search::search_from_primitive(input, taught, primitive, pool);
  }
}

// A face may be all that is measured of a part that stands on the other one, or reaches out of the image.
void PoseFinder::search_by_planes(const Context& context, const PartModel& model, search::HypothesisPool& pool) {
  Random random(context.seed, 3);
  const auto face = finder_.find(sample(), query_for(context.scene, PrimitiveKind::kPlane, kLeastFaceShare), random);
  if (!face) return;
  tell_found(context, model, *face);
  const search::SearchInput input = search_input(model);
  for (const Primitive& taught : model.taught()) search::search_from_primitive(input, taught, *face, pool);
}

void PoseFinder::tell_found(const Context& context, const PartModel& model, const Primitive& found) {
  if (trace_ != nullptr) trace_->primitive_found(static_cast<int>(&model - context.models.data()), found);
}

int PoseFinder::find_primitives(const Context& context, const PartModel& model, std::span<Primitive> found) {
  std::size_t count = 0;
  Random random(context.seed, 2);
  const auto looked_for = model.looked_for();
  for (std::size_t i = 0; i < looked_for.size() && count < found.size(); ++i) {
    const Primitive& taught = model.primitives[looked_for[i]];
    if (taught.kind == PrimitiveKind::kPlane) continue;
    const auto asked_before = [&](std::uint8_t other) { return search::may_match(taught, model.primitives[other]); };
    if (std::any_of(looked_for.begin(), looked_for.begin() + static_cast<std::ptrdiff_t>(i), asked_before)) continue;
    primitives::PrimitiveQuery query = query_for(context.scene, taught.kind, kLeastCurvedShare);
    query.radius_mm = taught.radius_mm;
    query.side = taught.concave ? primitives::Side::kBore : primitives::Side::kBoss;
    const auto primitive = finder_.find(sample(), query, random);
    if (primitive) found[count++] = *primitive;
  }
  return static_cast<int>(count);
}

void PoseFinder::shortlist(const Context& context, int model_index, Effort route, search::HypothesisPool& pool) {
  const PartModel& model = context.models[static_cast<std::size_t>(model_index)];
  const Breadth& breadth = route == Effort::kViews ? kByViews : kByPrimitives;
  std::array<Hypothesis, kMaxShortlist> hypotheses;
  const std::size_t count = pool.take_distinct(model, 0.04 * model.diagonal_mm, rad_from_deg(12.0),
                                               std::span(hypotheses).first(breadth.shortlist));
  std::array<Candidate, kMaxShortlist> tried;
  const std::size_t distinct =
      align_coarsely(context, model_index, std::span<const Hypothesis>(hypotheses).first(count), tried);
  const auto most = std::min({distinct, breadth.full, static_cast<std::size_t>(kMaxCandidates - candidate_count_)});
  std::partial_sort(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(most),
                    tried.begin() + static_cast<std::ptrdiff_t>(distinct),
                    [](const Candidate& a, const Candidate& b) { return a.impression > b.impression; });
  std::copy_n(tried.begin(), most, candidates_.begin() + candidate_count_);
  candidate_count_ += static_cast<int>(most);
}

// Writes where the hypotheses end, those that meet one before them left out; returns how many do not.
std::size_t PoseFinder::align_coarsely(const Context& context, int model_index, std::span<const Hypothesis> hypotheses,
                                       std::span<Candidate> ends) const {
  const PartModel& model = context.models[static_cast<std::size_t>(model_index)];
  const auto stages = coarse_stages(model);
  const auto sample = this->sample().first(std::min(sample_count_, kCoarseSample));
  std::array<Candidate, kMaxShortlist> halfway;
  std::size_t distinct_halfway = 0, distinct = 0;
  const auto met_before = [&](std::span<const Candidate> others, const Candidate& one) {
    return std::any_of(others.begin(), others.end(), [&](const Candidate& c) { return same_place(one, c, model); });
  };
  for (const Hypothesis& hypothesis : hypotheses) {
    Candidate candidate;
    candidate.model_index = model_index;
    candidate.hypothesis = hypothesis;
    candidate.alignment = icp::approach(sample, model, hypothesis.T_camera_part, std::span(stages).first<1>());
    if (met_before(std::span(halfway).first(distinct_halfway), candidate)) continue;
    halfway[distinct_halfway++] = candidate;
    candidate.alignment = icp::approach(sample, model, candidate.alignment.T_camera_part, std::span(stages).last<1>());
    if (met_before(ends.first(distinct), candidate)) continue;
    candidate.impression = impression(context, candidate).score;
    if (trace_ != nullptr) trace_->aligned_coarsely(candidate);
    ends[distinct++] = candidate;
  }
  return distinct;
}

// Aligns what is listed with the whole sample and weighs what then still makes an impression; the best of it always, to
// tell what was lacking.
void PoseFinder::weigh_shortlist(const Context& context, Effort route) {
  align_shortlist(context, route);
  const double best = best_impression();
  const auto aligned = std::span(candidates_).first(static_cast<std::size_t>(candidate_count_));
  candidate_count_ = 0;
  for (const Candidate& candidate : aligned) {
    if (candidate.impression < best && !impresses(candidate, best)) continue;
    Candidate& kept = candidates_[static_cast<std::size_t>(candidate_count_++)];
    kept = candidate;
    weigh(context, kept, Detail::kCoarse);
    if (trace_ != nullptr) trace_->weighed(kept);
  }
}

// The first route leaves out what makes no impression before; a view, or a face, is further from what it becomes. None
// keeps what ends where another one has ended.
void PoseFinder::align_shortlist(const Context& context, Effort route) {
  const double best = best_impression();
  const auto listed = std::span(candidates_).first(static_cast<std::size_t>(candidate_count_));
  candidate_count_ = 0;
  for (const Candidate& coarse : listed) {
    if (route == Effort::kPrimitives && best > kGoodImpression && coarse.impression < kLeastImpression * best) continue;
    Candidate candidate = coarse;
    align_fully(context, candidate);
    const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
    const auto ended_before = [&](const Candidate& other) { return same_place(candidate, other, model); };
    if (std::any_of(candidates_.begin(), candidates_.begin() + candidate_count_, ended_before)) continue;
    candidate.impression = impression(context, candidate).score;
    candidates_[static_cast<std::size_t>(candidate_count_++)] = candidate;
  }
}

double PoseFinder::best_impression() const {
  double best = -2.0;
  for (const Candidate& candidate : std::span(candidates_).first(static_cast<std::size_t>(candidate_count_)))
    best = std::max(best, candidate.impression);
  return best;
}

result::Impression PoseFinder::impression(const Context& context, const Candidate& candidate) {
  const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
  return result::first_impression(model, candidate.alignment.T_camera_part, context.scene,
                                  3.0 * result::surface_tolerance_mm(context.scene, model.spacing_mm));
}

void PoseFinder::align_fully(const Context& context, Candidate& candidate) {
  const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
  const auto stages = full_stages(model, result::surface_tolerance_mm(context.scene, model.spacing_mm));
  candidate.finished = false;
  candidate.alignment = icp::approach(sample(), model, candidate.alignment.T_camera_part, stages);
}

// Unless it is what was drawn last.
void PoseFinder::draw(const Context& context, const Candidate& candidate, Detail detail) {
  const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
  const result::PartPose& pose = candidate.alignment.T_camera_part;
  if (drawn_ && drawn_->model_index == candidate.model_index && drawn_->detail == detail &&
      drawn_->T_camera_part.rotation == pose.rotation && drawn_->T_camera_part.translation_mm == pose.translation_mm) {
    return;
  }
  drawing_.draw(detail == Detail::kFine ? model.fine : model.coarse, pose, context.scene.lens);
  drawn_ = {candidate.model_index, detail, pose};
}

void PoseFinder::weigh(const Context& context, Candidate& candidate, Detail detail) {
  const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
  draw(context, candidate, detail);
  candidate.evidence =
      result::weigh(drawing_, model, candidate.alignment.T_camera_part, context.scene,
                    {context.owner, {context.object.labels, static_cast<std::size_t>(context.object.label_count)}});
  candidate.strength = strength(candidate.evidence);
  candidate.region = drawing_.region();
}

// The last alignment uses everything measured where the part is in sight, whatever segment it fell into: first what
// lies a little off, then closely. Returns whether enough was measured there.
bool PoseFinder::align_in_sight(const Context& context, Candidate& candidate, const Look& look) {
  const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
  const double radius_mm = look.tolerances * result::surface_tolerance_mm(context.scene, model.spacing_mm);
  draw(context, candidate, look.detail);
  const std::size_t count =
      sample_at_pose(context.scene.range, context.scene.labels, drawing_, radius_mm, look.sample, pose_sample_);
  pose_sample_count_ = count;
  if (count < kLeastSample) return false;
  const std::size_t pairs =
      pair_outline(drawing_, candidate.alignment.T_camera_part, context.scene, model.spacing_mm, 2.0 * radius_mm + 1.0,
                   result::free_space_tolerance_mm(context.scene, model.spacing_mm), outline_);
  const std::array<icp::Stage, 1> stage{icp::Stage{radius_mm, 12, 0.85F, 0.0F, kSettled}};
  candidate.alignment = icp::align(pose_sample_.first(count), model, candidate.alignment.T_camera_part, stage,
                                   icp::Noise{context.scene.noise_mm}, outline_.first(pairs));
  return true;
}

void PoseFinder::finish(const Context& context, Candidate& candidate) {
  if (align_in_sight(context, candidate, kOff)) finish_closely(context, candidate);
}

void PoseFinder::finish_closely(const Context& context, Candidate& candidate) {
  if (!align_in_sight(context, candidate, kClose)) return;
  weigh_closely(context, candidate);
  candidate.finished = true;
}

void PoseFinder::weigh_closely(const Context& context, Candidate& candidate) {
  const PartModel& model = context.models[static_cast<std::size_t>(candidate.model_index)];
  weigh(context, candidate, Detail::kFine);
  candidate.evidence.blemishes = blemishes_.find(drawing_, context.scene, model.spacing_mm);
}

}  // namespace beltpick::pipeline
