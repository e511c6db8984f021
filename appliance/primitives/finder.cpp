#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"
#include "primitives/cost.hpp"
#include "primitives/hypothesis.hpp"
#include "primitives/msac.hpp"
#include "primitives/refine.hpp"

namespace beltpick::primitives {

struct Finder::Found {
  Model model;
  Support support;
  double gain = 0.0;  // what the model explains, in points: how far (5) lies below that of no model, over T
  const PrimitiveQuery* query = nullptr;
};

namespace {

constexpr int kMinPoints = 12;

// Trials after which one sample of inliers only has been drawn with the query's confidence, were `share` of the points
// inliers.
double trials_for(const PrimitiveQuery& query, double share) {
  const double hit = std::pow(std::clamp(share, 1e-4, 0.999), sample_size(query));
  return std::log(1.0 - query.confidence) / std::log1p(-hit);
}

struct Candidate {
  Model model;
  double cost_mm2;
};

// Refines a hypothesis that is the best so far, and keeps the refined one where it is better.
void polish(const Cloud& cloud, const PrimitiveQuery& query, Candidate& best) {
  for (const double widening : {2.0, 1.0}) {
    Candidate polished = best;
    if (!refine(cloud, query, 3, widening, polished.model)) continue;
    polished.cost_mm2 = cost_mm2(cloud, polished.model, query, best.cost_mm2);
    if (polished.cost_mm2 < best.cost_mm2) best = polished;
  }
}

std::optional<Candidate> msac(const Cloud& cloud, const PrimitiveQuery& query, int needed, Random& random) {
  const double nothing_mm2 = threshold_mm2(query) * cloud.count;
  Candidate best{{}, nothing_mm2};
  const double bound = trials_for(query, static_cast<double>(needed) / cloud.count);
  double trials = std::min(bound, static_cast<double>(query.max_trials));
  for (int trial = 0; trial < trials; ++trial) {
    const auto model = draw_hypothesis(cloud, query, random);
    if (!model) continue;
    const double cost = cost_mm2(cloud, *model, query, best.cost_mm2);
    if (cost >= best.cost_mm2) continue;
    best = {*model, cost};
    polish(cloud, query, best);
    trials = std::min(trials, 8.0 + 2.0 * trials_for(query, 1.0 - best.cost_mm2 / nothing_mm2));
  }
  if (best.cost_mm2 >= nothing_mm2) return std::nullopt;
  return best;
}

Primitive primitive_of(const Cloud& cloud, const Model& model, const Support& support, int all_points) {
  Primitive primitive;
  primitive.kind = model.kind;
  primitive.direction = model.direction;
  primitive.radius_mm = model.kind == PrimitiveKind::kPlane ? 0.0 : model.radius_mm;
  primitive.extent_mm = support.extent_mm;
  primitive.concave = model.kind != PrimitiveKind::kPlane && model.side < 0;
  primitive.inlier_share = static_cast<double>(support.inliers) / all_points;
  primitive.rms_mm = support.rms_mm;
  Vec3 point_mm = model.point_mm;
  if (model.kind == PrimitiveKind::kCylinder) point_mm += support.middle_mm * model.direction;
  if (model.kind == PrimitiveKind::kPlane) {
    point_mm = support.centroid_mm - residual(model, support.centroid_mm).distance_mm * model.direction;
  }
  primitive.point_mm = point_mm + cloud.origin_mm;
  return primitive;
}

// More freedoms fit any points better: a curved surface must beat a plane by a margin.
double preference(PrimitiveKind kind) { return kind == PrimitiveKind::kPlane ? 1.0 : 0.95; }

}  // namespace

Finder::Finder(Arena& arena, int max_points) : cloud_(arena, max_points) {}

std::optional<Finder::Found> Finder::search(const PrimitiveQuery& query, int all_points, Random& random) {
  const int needed = std::max(kMinPoints, static_cast<int>(query.min_share * all_points));
  if (cloud_.count < needed) return std::nullopt;
  auto best = msac(cloud_, query, needed, random);
  if (!best) return std::nullopt;
  refine(cloud_, query, 6, 1.0, best->model);
  Found found{best->model, support_of(cloud_, best->model, query), 0.0, &query};
  if (found.support.inliers < needed) return std::nullopt;
  if (query.kind == PrimitiveKind::kCylinder && found.support.arc_rad < query.min_arc_rad) return std::nullopt;
  found.gain = cloud_.count - cost_mm2(cloud_, found.model, query, 1e30) / threshold_mm2(query);
  return found;
}

std::optional<Finder::Found> Finder::best_of(std::span<const PrimitiveQuery> queries, int all_points, Random& random) {
  std::optional<Found> best;
  for (const PrimitiveQuery& query : queries) {
    const auto found = search(query, all_points, random);
    if (!found) continue;
    if (!best || found->gain * preference(query.kind) > best->gain * preference(best->query->kind)) best = found;
  }
  return best;
}

void Finder::remove_inliers(const PrimitiveQuery& query, const Model& model) {
  // Beyond the inliers proper: the primitive's own noisy points would otherwise be found again as a thin shell.
  PrimitiveQuery wide = query;
  wide.sigma_mm *= 1.5;
  wide.normal_angle_max_rad *= 1.5;
  const InlierRule rule(wide);
  int kept = 0;
  for (int i = 0; i < cloud_.count; ++i) {
    if (!rule.holds(cloud_, i, model, residual(model, cloud_.point(i)))) cloud_.copy_point(i, kept++);
  }
  cloud_.count = kept;
}

Result<Primitive> Finder::find(std::span<const OrientedPoint> points, const PrimitiveQuery& query, Random& random) {
  cloud_.load(points);
  if (cloud_.count < kMinPoints) {
    return failure(ResultCode::kTooFewPoints, "primitive: expected at least %d points, found %d", kMinPoints,
                   cloud_.count);
  }
  const auto found = search(query, cloud_.count, random);
  if (!found) {
    return failure(ResultCode::kNothingFound, "primitive: none holds %.0f %% of the %d points within %.3g mm",
                   100 * query.min_share, cloud_.count, std::sqrt(threshold_mm2(query)));
  }
  return primitive_of(cloud_, found->model, found->support, cloud_.count);
}

int Finder::find_sequence(std::span<const OrientedPoint> points, std::span<const PrimitiveQuery> queries,
                          std::span<Primitive> out, Random& random) {
  cloud_.load(points);
  const int all_points = cloud_.count;
  int written = 0;
  while (written < static_cast<int>(out.size())) {
    const auto found = best_of(queries, all_points, random);
    if (!found) break;
    out[written++] = primitive_of(cloud_, found->model, found->support, all_points);
    remove_inliers(*found->query, found->model);
  }
  return written;
}

}  // namespace beltpick::primitives
