#include "twins/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "base/arena.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "icp/align.hpp"
#include "pipeline/model_store.hpp"
#include "result/scene.hpp"
#include "search/hypothesis_pool.hpp"
#include "search/views.hpp"
#include "twins/seen_side.hpp"
#include "twins/whole_fit.hpp"

namespace beltpick::twins {
namespace {

constexpr double kNoise_mm = 0.05;
constexpr std::size_t kViews = 42;  // of the divided icosahedron's directions, evenly chosen
constexpr std::size_t kSearchPoints = 100;
constexpr std::size_t kAlignPoints = 700;
constexpr std::size_t kAligned = 10;
// Of two rivals the one prevails for which some 30 pixels speak more (result/rivalry); of 0.3 mm each, and with that
// many again lost to edges, shadows and highlights, twice.
constexpr double kAreaNeeded_mm2 = 12.0;
constexpr double kSameShare = 0.0005;  // sampling alone leaves less
constexpr double kMirrorShare = 0.002;
constexpr double kStrangerShare = 0.25;

// Both templates as the pose search uses them.
struct Models {
  std::unique_ptr<ArenaBlock> block;
  std::unique_ptr<Arena> arena;
  std::unique_ptr<pipeline::ModelStore> store;

  static Result<Models> make(const PartTemplate& taught, const PartTemplate& other) {
    Limits limits;
    limits.templates = 2;
    const std::array<PartTemplate, 2> both{taught, other};
    if (auto fits = pipeline::check_templates(both, limits); !fits) return std::unexpected(fits.error());
    Models models;
    Arena measuring;
    const pipeline::ModelStore sizes(measuring, limits);
    models.block = std::make_unique<ArenaBlock>(measuring.used_bytes());
    models.arena = std::make_unique<Arena>(models.block->data(), models.block->bytes());
    models.store = std::make_unique<pipeline::ModelStore>(*models.arena, limits);
    if (auto loaded = models.store->load(both); !loaded) return std::unexpected(loaded.error());
    return models;
  }
};

std::vector<OrientedPoint> sample(const std::vector<OrientedPoint>& seen, std::size_t count) {
  std::vector<OrientedPoint> chosen;
  Random random(2);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(seen[random.below(static_cast<std::uint32_t>(seen.size()))]);
  return chosen;
}

// The part `own` is seen along `sight`: by how much does `other` differ, in the pose that differs least?
double least_difference_mm2(const PartModel& own, const PartModel& other, const Vec3& sight, double tolerance_mm) {
  const PartPose T_camera_own = look_along(own, sight);
  const std::vector<OrientedPoint> seen = seen_side(own, T_camera_own);
  double least = std::numeric_limits<double>::max();
  if (seen.size() < kSearchPoints) return least;
  std::vector<Hypothesis> storage(200);
  search::HypothesisPool pool(storage);
  const std::vector<OrientedPoint> few = sample(seen, kSearchPoints);
  search::search_views({other, search::SearchSample(few), static_cast<float>(0.05 * other.diagonal_mm)}, pool);
  std::array<Hypothesis, kAligned> best;
  const std::size_t count = pool.take_distinct(other, 0.04 * other.diagonal_mm, rad_from_deg(12.0), best);
  const std::array<icp::Stage, 3> stages{icp::Stage{0.06 * other.diagonal_mm, 8, 0.3F},
                                         icp::Stage{0.02 * other.diagonal_mm, 10, 0.5F},
                                         icp::Stage{3.0 * tolerance_mm, 12, 0.7F}};
  const std::vector<OrientedPoint> more = sample(seen, kAlignPoints);
  for (std::size_t i = 0; i < count; ++i) {
    const PartPose pose = icp::align(more, other, best[i].T_camera_part, stages, icp::Noise{}).T_camera_part;
    const double forth = area_off_mm2(seen, static_cast<double>(own.spacing_mm), other, pose, tolerance_mm, least);
    if (forth >= least) continue;
    const double back = area_off_mm2(seen_side(other, pose), static_cast<double>(other.spacing_mm), own, T_camera_own,
                                     tolerance_mm, least);
    least = std::min(least, std::max(forth, back));
  }
  return least;
}

std::vector<View> all_views(const PartModel& own, const PartModel& other, double tolerance_mm) {
  std::vector<View> views;
  const auto& directions = search::view_directions();
  for (std::size_t i = 0; i < kViews; ++i) {
    const Vec3& sight = directions[i * directions.size() / kViews];
    views.push_back({sight, least_difference_mm2(own, other, sight, tolerance_mm)});
  }
  return views;
}

std::size_t blind(const std::vector<View>& views, double needed_mm2) {
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [&](const View& view) { return view.difference_mm2 < needed_mm2; }));
}

void take_whole(const PartModel& taught, const PartModel& other, Comparison& comparison) {
  const WholeFit forth = fit_whole(taught.surface, other, comparison.tolerance_mm);
  const WholeFit back = fit_whole(other.surface, taught, comparison.tolerance_mm);
  // A boss more is off the surface, a hole more hardly: it shows where it lacks.
  const bool on_other = back.largest_mm > forth.largest_mm;
  comparison.differing_share = std::max(forth.differing_share, back.differing_share);
  comparison.largest_mm = std::max(forth.largest_mm, back.largest_mm);
  comparison.where_mm = on_other ? Vec3(back.T_own_other.inverse() * back.where_mm) : forth.where_mm;
  const WholeFit image = fit_whole(mirrored(taught.surface), other, comparison.tolerance_mm);
  if (comparison.differing_share < kSameShare) {
    comparison.kinship = Kinship::kSame;
  } else if (image.differing_share < kMirrorShare) {
    comparison.kinship = Kinship::kMirrorTwins;
  } else if (comparison.differing_share < kStrangerShare) {
    comparison.kinship = Kinship::kNearTwins;
  }
}

Comparison compare_whole(const PartModel& taught, const PartModel& other) {
  Comparison comparison;
  comparison.area_needed_mm2 = kAreaNeeded_mm2;
  result::Scene scene;
  scene.noise_mm = kNoise_mm;
  comparison.tolerance_mm =
      result::surface_tolerance_mm(scene, static_cast<double>(std::max(taught.spacing_mm, other.spacing_mm)));
  take_whole(taught, other, comparison);
  return comparison;
}

}  // namespace

double Comparison::blind_share() const {
  const auto total = static_cast<double>(taught_as_other.size() + other_as_taught.size());
  return total == 0.0
             ? 0.0
             : static_cast<double>(blind(taught_as_other, area_needed_mm2) + blind(other_as_taught, area_needed_mm2)) /
                   total;
}

Result<Comparison> compare_whole(const PartTemplate& taught, const PartTemplate& other) {
  const auto models = Models::make(taught, other);
  if (!models) return std::unexpected(models.error());
  return compare_whole(models->store->models()[0], models->store->models()[1]);
}

Result<Comparison> compare(const PartTemplate& taught, const PartTemplate& other) {
  const auto models = Models::make(taught, other);
  if (!models) return std::unexpected(models.error());
  const PartModel& one = models->store->models()[0];
  const PartModel& two = models->store->models()[1];
  Comparison comparison = compare_whole(one, two);
  if (comparison.kinship == Kinship::kSame) return comparison;
  comparison.taught_as_other = all_views(one, two, comparison.tolerance_mm);
  comparison.other_as_taught = all_views(two, one, comparison.tolerance_mm);
  return comparison;
}

bool worrying(const Comparison& comparison) {
  return comparison.kinship == Kinship::kSame || comparison.blind_share() > 0.0;
}

std::string sentence(const Comparison& comparison, const std::string& other) {
  std::array<char, 500> line{};
  if (comparison.kinship == Kinship::kSame) {
    std::snprintf(
        line.data(), line.size(),
        "%s: nothing differs by more than the %.2f mm that the measurement can tell: loaded together, neither "
        "will be located; load one of them",
        other.c_str(), comparison.tolerance_mm);
    return line.data();
  }
  const char* kin = comparison.kinship == Kinship::kMirrorTwins ? "the mirror image"
                    : comparison.kinship == Kinship::kNearTwins ? "a near twin"
                                                                : "another shape";
  int used = std::snprintf(line.data(), line.size(),
                           "%s: %s; %.1f %% of the surface differs, by up to %.1f mm at (%.0f, %.0f, %.0f) mm; ",
                           other.c_str(), kin, 100 * comparison.differing_share, comparison.largest_mm,
                           comparison.where_mm.x(), comparison.where_mm.y(), comparison.where_mm.z());
  const auto rest = line.size() - static_cast<std::size_t>(used);
  if (comparison.blind_share() > 0.0) {
    const auto least =
        std::min_element(comparison.taught_as_other.begin(), comparison.taught_as_other.end(),
                         [](const View& a, const View& b) { return a.difference_mm2 < b.difference_mm2; });
    std::snprintf(line.data() + used, rest,
                  "from %.0f %% of directions nothing of that is seen (least when looking along (%.1f, %.1f, %.1f)): "
                  "loaded together, parts that lie so are withheld as POSE_AMBIGUOUS",
                  100 * comparison.blind_share(), least->sight.x(), least->sight.y(), least->sight.z());
  } else {
    std::snprintf(line.data() + used, rest, "told apart from every direction");
  }
  return line.data();
}

}  // namespace beltpick::twins
