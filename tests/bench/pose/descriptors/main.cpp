// bench_pose_descriptors: local features (spin images) against the product's search, on the same objects of the same
// scenes. Takes the options of bench_pose (--help) as far as they choose scenes.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>

#include "base/clock.hpp"
#include "bench/pose/descriptors/trial.hpp"
#include "bench/pose/need.hpp"
#include "bench/pose/options.hpp"
#include "bench/pose/quantile.hpp"
#include "pipeline/noise.hpp"
#include "pipeline/object_points.hpp"

namespace beltpick::bench {
namespace {

constexpr double kLeastVisible = 0.6;       // of a part
constexpr double kLeastSegmentShare = 0.5;  // of the part's pixels that one segment holds
constexpr double kLeastPurity = 0.9;        // of the segment's pixels that are the part's

using Outcomes = std::array<Outcome, kWayNames.size()>;
struct Tried {
  std::string family;
  Outcomes outcomes;
};

class Bench {
 public:
  Bench(const Options& options, const PartPool& pool)
      : pool_(pool),
        camera_(pool, options.width, options.height, options.noise_mm),
        machine_(limits(options)),
        trial_(limits(options)) {
    plan_options_ = {options.seed, options.rendered_every, {}, options.parts};
    for (const std::string& kind : options.kinds) plan_options_.kinds.push_back(scene_kind(kind));
  }

  void run(int k) {
    const ScenePlan plan = plan_scene(pool_, plan_options_, k);
    if (plan.loaded != loaded_) load(plan);
    const SeenScene seen = camera_.look(plan, machine_);
    const auto located = need(machine_.pipeline.locate(
        {seen.range, camera_.calibration().camera, pipeline::projector_position_mm(camera_.calibration()), 1}));
    result::Scene scene{.range = seen.range,
                        .labels = located.objects.labels,
                        .lens = camera_.calibration().camera,
                        .belt = located.objects.belt};
    scene.noise_mm = pipeline::measurement_noise_mm(seen.range, located.objects.labels);
    for (std::size_t i = 0; i < seen.truth.parts.size(); ++i) try_part(static_cast<int>(i), seen, plan, located, scene);
  }

  void print() const;

 private:
  void load(const ScenePlan& plan) {
    std::vector<PartTemplate> templates;
    for (const int index : plan.loaded) templates.push_back(pool_.templates[static_cast<std::size_t>(index)]);
    need(machine_.pipeline.load(templates));
    loaded_ = plan.loaded;
    const Stopwatch teaching;
    spins_.clear();
    for (const PartModel& model : machine_.pipeline.models()) spins_.emplace_back(model, SpinOptions{});
    teach_ms_ = teaching.elapsed_ms() / static_cast<double>(spins_.size());
  }

  static Limits limits(const Options& options) {
    Limits limits;
    limits.image_width = options.width;
    limits.image_height = options.height;
    return limits;
  }

  // The part's object, where the product's segmentation gives it one that is nothing else's.
  void try_part(int i, const SeenScene& seen, const ScenePlan& plan, const pipeline::Located& located,
                const result::Scene& scene) {
    const auto& truth = seen.truth.parts[static_cast<std::size_t>(i)];
    const auto loaded = std::find(plan.loaded.begin(), plan.loaded.end(), seen.part[static_cast<std::size_t>(i)]);
    if (loaded == plan.loaded.end() || truth.visible_fraction < kLeastVisible) return;
    const Segment* segment = own_segment(i, seen, located);
    if (segment == nullptr) return;
    pipeline::Object pixels;
    pixels.add(*segment);
    const auto model = static_cast<std::size_t>(loaded - plan.loaded.begin());
    TrialObject object;
    object.sample.resize(4096);
    object.sample.resize(pipeline::sample_object(seen.range, located.objects.labels, pixels, 1000, 1, object.sample));
    if (object.sample.size() < 60) return;
    object.model = &machine_.pipeline.models()[model];
    object.truth = truth.T_camera_part;
    object.noise_mm = scene.noise_mm;
    results_.push_back({truth.part, trial_.run(object, scene, spins_[model])});
  }

  static const Segment* own_segment(int i, const SeenScene& seen, const pipeline::Located& located) {
    std::map<std::uint16_t, int> count;
    int pixels = 0;
    for (int row = 0; row < seen.instances.rows; ++row) {
      for (int col = 0; col < seen.instances.cols; ++col) {
        if (seen.instances(row, col) != i + 1) continue;
        ++pixels;
        ++count[located.objects.labels(row, col)];
      }
    }
    for (const Segment& segment : located.objects.segments) {
      const int shared = count[segment.label];
      if (shared > kLeastSegmentShare * pixels && shared > kLeastPurity * segment.pixels) return &segment;
    }
    return nullptr;
  }

  const PartPool& pool_;
  PlanOptions plan_options_;
  BeltCamera camera_;
  Machine machine_;
  Trial trial_;
  std::vector<int> loaded_;
  std::vector<SpinModel> spins_;  // of the loaded parts
  double teach_ms_ = 0.0;
  std::vector<Tried> results_;
};

void Bench::print() const {
  std::map<std::string, std::vector<const Outcomes*>> groups;
  for (const Tried& result : results_) {
    groups[result.family].push_back(&result.outcomes);
    groups["all"].push_back(&result.outcomes);
  }
  std::printf("%-12s %-42s %8s %8s %10s %10s\n", "part", "hypotheses by", "objects", "right %", "median ms", "99 % ms");
  for (const auto& [family, outcomes] : groups) {
    for (std::size_t way = 0; way < kWayNames.size(); ++way) {
      int right = 0;
      std::vector<double> ms;
      for (const Outcomes* one : outcomes) {
        right += (*one)[way].right ? 1 : 0;
        ms.push_back((*one)[way].ms);
      }
      std::printf("%-12s %-42s %8zu %8.2f %10.1f %10.1f\n", family.c_str(), std::string(kWayNames[way]).c_str(),
                  outcomes.size(), 100.0 * right / static_cast<double>(outcomes.size()), quantile(ms, 0.5),
                  quantile(ms, 0.99));
    }
  }
  std::printf("a part's spin images are made in %.0f ms, when it is loaded\n", teach_ms_);
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  using namespace beltpick::bench;
  try {
    const Options options = read_options(argc, argv);
    const PartPool pool = make_part_pool(options.families, options.templates);
    Bench bench(options, pool);
    for (int k = options.first_scene; k < options.first_scene + options.scenes; ++k) {
      std::fprintf(stderr, "\r%d/%d", k - options.first_scene, options.scenes);
      bench.run(k);
    }
    std::fputs("\r", stderr);
    bench.print();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_pose_descriptors: %s\n", error.what());
    return 1;
  }
}
