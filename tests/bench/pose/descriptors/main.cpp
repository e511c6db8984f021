// bench_pose_descriptors: local features (spin images) against the product's search, on the same objects of the same
// scenes. Takes the options of bench_pose (--help) as far as they choose scenes.
#include <algorithm>
#include <cstdio>
#include <map>

#include "base/clock.hpp"
#include "bench/pose/descriptors/trial.hpp"
#include "bench/pose/quantile.hpp"
#include "bench/pose/scene_bench.hpp"
#include "bench/pose/scene_loop.hpp"
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
  Bench(const Options& options, const PartPool& pool) : bench_(options, pool), trial_(bench_.machine().limits) {}

  void run(int k) {
    const SceneBench::Scene shown = bench_.run(k);
    if (shown.plan.loaded != loaded_) make_spins(shown.plan);
    result::Scene scene{.range = shown.seen.range,
                        .labels = shown.located.objects.labels,
                        .lens = bench_.calibration().camera,
                        .belt = shown.located.objects.belt};
    scene.noise_mm = pipeline::measurement_noise_mm(shown.seen.range, shown.located.objects.labels);
    for (std::size_t i = 0; i < shown.seen.truth.parts.size(); ++i) try_part(static_cast<int>(i), shown, scene);
  }

  void print() const;

 private:
  void make_spins(const ScenePlan& plan) {
    loaded_ = plan.loaded;
    const Stopwatch teaching;
    spins_.clear();
    for (const PartModel& model : bench_.machine().pipeline.models()) spins_.emplace_back(model, SpinOptions{});
    teach_ms_ = teaching.elapsed_ms() / static_cast<double>(spins_.size());
  }

  // The part's object, where the product's segmentation gives it one that is nothing else's.
  void try_part(int i, const SceneBench::Scene& shown, const result::Scene& scene) {
    const ScenePlan& plan = shown.plan;
    const SeenScene& seen = shown.seen;
    const pipeline::Located& located = shown.located;
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
    object.model = &bench_.machine().pipeline.models()[model];
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

  SceneBench bench_;
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
  return beltpick::bench::run_scene_loop<beltpick::bench::Bench>("bench_pose_descriptors", argc, argv);
}
