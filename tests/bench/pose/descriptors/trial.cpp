#include "bench/pose/descriptors/trial.hpp"

#include <algorithm>

#include "base/clock.hpp"
#include "base/units.hpp"
#include "icp/align.hpp"
#include "pipeline/pose_finder.hpp"
#include "result/evidence.hpp"
#include "search/views.hpp"

namespace beltpick::bench {
namespace {

constexpr std::size_t kPool = 400;  // as the product's

std::size_t finder_bytes(const Limits& limits) {
  Arena measuring;
  const primitives::Finder finder(measuring, limits.object_points);
  return measuring.used_bytes();
}

struct Aligned {
  Alignment alignment;
  double impression = -2.0;
};

}  // namespace

Trial::Trial(const Limits& limits)
    : block_(finder_bytes(limits)),
      arena_(block_.data(), block_.bytes()),
      finder_(arena_, limits.object_points),
      storage_(kPool) {}

// Cylinders and spheres of the part, or one face, and what they leave free; thresholds as the product's.
void Trial::search_primitives(const TrialObject& object, const search::SearchInput& input, bool faces,
                              search::HypothesisPool& pool) {
  Random random(1, faces ? 3 : 2);
  for (const Primitive& taught : object.model->taught()) {
    if ((taught.kind == PrimitiveKind::kPlane) != faces) continue;
    primitives::PrimitiveQuery query;
    query.kind = taught.kind;
    query.sigma_mm = std::max(object.noise_mm, 0.1);
    query.min_share = faces ? 0.2 : 0.12;
    query.max_trials = 400;
    if (!faces) query.radius_mm = taught.radius_mm;
    if (!faces) query.side = taught.concave ? primitives::Side::kBore : primitives::Side::kBoss;
    const auto found = finder_.find(object.sample, query, random);
    if (found) {
      for (const Primitive& same : object.model->taught()) search::search_from_primitive(input, same, *found, pool);
    }
    if (faces) return;  // the largest face is the same whichever is asked for
  }
}

// Aligns the best distinct hypotheses coarsely, the best-looking of them fully, as the product does.
bool Trial::any_right(const TrialObject& object, const result::Scene& scene, search::HypothesisPool& pool,
                      std::size_t shortlist, std::size_t full) const {
  const PartModel& model = *object.model;
  std::vector<Hypothesis> hypotheses(shortlist);
  hypotheses.resize(pool.take_distinct(model, 0.04 * model.diagonal_mm, rad_from_deg(12.0), hypotheses));
  const double coarse_mm = pipeline::coarse_radius_mm(model), fine_mm = 0.03 * model.diagonal_mm;
  const double tolerance_mm = result::surface_tolerance_mm(scene, model.spacing_mm);
  const std::array<icp::Stage, 2> roughly{icp::Stage{coarse_mm, 8, 0.3F, 0.3F}, icp::Stage{fine_mm, 6, 0.5F, 0.3F}};
  const std::array<icp::Stage, 2> finely{icp::Stage{fine_mm, 15, 0.5F, 0.2F},
                                         icp::Stage{3.0 * tolerance_mm, 15, 0.7F, 0.1F}};
  const std::span<const OrientedPoint> sample = object.sample;
  std::vector<Aligned> tried;
  for (const Hypothesis& hypothesis : hypotheses) {
    Aligned one;
    one.alignment = icp::align(sample.first(std::min<std::size_t>(sample.size(), 200)), model, hypothesis.T_camera_part,
                               roughly, icp::Noise{object.noise_mm});
    one.impression = result::first_impression(model, one.alignment.T_camera_part, scene, 3.0 * tolerance_mm).score;
    tried.push_back(one);
  }
  std::stable_sort(tried.begin(), tried.end(),
                   [](const Aligned& a, const Aligned& b) { return a.impression > b.impression; });
  bool right = false;
  for (std::size_t i = 0; i < std::min(full, tried.size()); ++i) {
    const Alignment last =
        icp::align(sample, model, tried[i].alignment.T_camera_part, finely, icp::Noise{object.noise_mm});
    right = right || !grasp_error(last.T_camera_part, object.truth, model, -1).wrong();
  }
  return right;
}

Outcome Trial::attempt(const TrialObject& object, const result::Scene& scene, const SpinModel& spin, Way way) {
  const PartModel& model = *object.model;
  const Stopwatch watch;
  const search::SearchSample sample(
      std::span(object.sample).first(std::min(object.sample.size(), pipeline::kSearchSample)));
  const search::SearchInput input{model, sample, static_cast<float>(pipeline::coarse_radius_mm(model))};
  search::HypothesisPool pool(storage_);
  std::size_t shortlist = 40, full = 6;
  if (way == Way::kPrimitives || way == Way::kPlanes) {
    search_primitives(object, input, way == Way::kPlanes, pool);
  } else if (way == Way::kViews) {
    search::search_views(input, pool);
    shortlist = 80, full = 10;
  } else {
    spin.search(object.sample, input, pool);
  }
  const bool right = any_right(object, scene, pool, shortlist, full);
  return {right, watch.elapsed_ms()};
}

std::array<Outcome, kWayNames.size()> Trial::run(const TrialObject& object, const result::Scene& scene,
                                                 const SpinModel& spin) {
  const Outcome primitives = attempt(object, scene, spin, Way::kPrimitives);
  const Outcome views = attempt(object, scene, spin, Way::kViews);
  const Outcome face = attempt(object, scene, spin, Way::kPlanes);
  const Outcome spun = attempt(object, scene, spin, Way::kSpin);
  const auto else_try = [](const Outcome& first, const Outcome& second) {
    return first.right ? first : Outcome{second.right, first.ms + second.ms};
  };
  const Outcome product = else_try(else_try(primitives, views), face);
  return {primitives, views, face, spun, product, else_try(spun, product), else_try(product, spun)};
}

}  // namespace beltpick::bench
