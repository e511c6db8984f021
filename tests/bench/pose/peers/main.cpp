// bench_pose_peers: the product beside VTK's ICP, PCL's ICP and OpenCV's point pair features, on the same objects of
// the same scenes, one thread each. Run by `bench_pose --peers`; takes its options.
//
// An object is what the product's segmenter made of the image: of every part of which half was measured, the segment
// that shows most of it. The peers get 1000 of its points with normals and the template. VTK and PCL need a start: they
// get the best of the product's search over all views of the part (162 views x 24 turns, as the paper's search but
// finer): VTK, as in the paper, the best one; PCL the best three, and keeps what fits best. That search's time is
// counted for them. OpenCV's point pair features propose five poses; its own ICP refines them, and, since that does
// poorly where much of a part is hidden, in a row of its own PCL's. OpenCV's detectors are trained before the first
// scene, --jobs at a time; that is not counted. The peers always answer; the product may withhold. Errors count at the
// part's first grasp.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "base/clock.hpp"
#include "bench/pose/judge.hpp"
#include "bench/pose/peers/opencv_peer.hpp"
#include "bench/pose/peers/pcl_peer.hpp"
#include "bench/pose/peers/vtk_peer.hpp"
#include "bench/pose/quantile.hpp"
#include "bench/pose/scene_bench.hpp"
#include "bench/pose/scene_loop.hpp"
#include "pipeline/object_points.hpp"
#include "search/views.hpp"

namespace beltpick::bench {
namespace {

constexpr std::size_t kSample = 1000;       // the paper's
constexpr std::size_t kSearchSample = 100;  // the paper's
constexpr std::size_t kStarts = 3;
constexpr std::size_t kProposed = 5;  // by point pair features
constexpr double kLeastMeasured = 0.5;

struct Row {
  const char* name;
  int right = 0, wrong = 0, none = 0;
  std::vector<double> ms, off_mm;  // off: of all answers, at the grasp
};

class Contest {
 public:
  Contest(const Options& options, const PartPool& pool) : options_(options), pool_(pool), bench_(options, pool) {
    train();
  }

  // Scene number `k`.
  void run(int k) {
    const SceneBench::Scene scene = bench_.run(k);
    const std::vector<int>& loaded = scene.plan.loaded;
    for (std::size_t i = 0; i < scene.seen.part.size(); ++i) {
      const auto at = std::find(loaded.begin(), loaded.end(), scene.seen.part[i]);
      const ShownPart here = shown_part(scene.seen, scene.located, static_cast<int>(i));
      const double measured = scene.seen.truth.parts[i].visible_fraction * here.measured_share();
      if (at == loaded.end() || here.segment == 0 || measured < kLeastMeasured) continue;
      ++objects_;
      const auto model_index = static_cast<int>(at - loaded.begin());
      const PartPose& truth = scene.seen.truth.parts[i].T_camera_part;
      judge_product(scene.located, model_index, truth, here.segment);
      run_peers(scene, here.segment, scene.seen.part[i], model_index, truth);
    }
  }

  void print() const {
    nlohmann::json line{{"seed", options_.seed},
                        {"scenes", options_.scenes},
                        {"objects", objects_},
                        {"start_search_ms", quantile(search_ms_, 0.5)}};
    std::printf("%d objects; starts for VTK and PCL: %.1f ms (median), counted in their times\n", objects_,
                quantile(search_ms_, 0.5));
    std::printf("%-34s %7s %7s %8s  %12s %12s %14s\n", "", "right", "wrong", "withheld", "median ms", "99 % ms",
                "median mm off");
    for (const Row& row : rows_) {
      std::printf("%-34s %5.1f %% %7d %8d  %12.1f %12.1f %14.3f\n", row.name, 100.0 * row.right / std::max(1, objects_),
                  row.wrong, row.none, quantile(row.ms, 0.5), quantile(row.ms, 0.99), quantile(row.off_mm, 0.5));
      line["methods"][row.name] = {{"right", row.right},
                                   {"wrong", row.wrong},
                                   {"withheld", row.none},
                                   {"median_ms", quantile(row.ms, 0.5)},
                                   {"p99_ms", quantile(row.ms, 0.99)},
                                   {"median_off_mm", quantile(row.off_mm, 0.5)}};
    }
    std::printf("%s\n", line.dump().c_str());
  }

 private:
  // OpenCV's detectors of all parts whose templates some scene loads.
  void train() {
    std::set<int> needed;
    for (const int k : scene_numbers(options_)) {
      for (const int part : bench_.plan(k).loaded) needed.insert(part);
    }
    for (const int part : needed) detectors_.emplace(part, pool_.templates[static_cast<std::size_t>(part)]);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t at = next++; at < detectors_.size(); at = next++) {
        const auto detector = std::next(detectors_.begin(), static_cast<std::ptrdiff_t>(at));
        const Stopwatch watch;
        detector->second.train();
        std::fprintf(stderr, "OpenCV's detector for %s is trained: %.1f s\n",
                     pool_.templates[static_cast<std::size_t>(detector->first)].name.c_str(),
                     watch.elapsed_ms() / 1000.0);
      }
    };
    std::vector<std::jthread> threads;
    for (int job = 0; job < options_.jobs; ++job) threads.emplace_back(work);
  }

  // Right or wrong by the pose offered that lies nearest to the part, within half its size.
  void judge_product(const pipeline::Located& located, int model_index, const PartPose& truth, std::uint16_t segment) {
    const PartModel& model = bench_.machine().pipeline.models()[static_cast<std::size_t>(model_index)];
    bool right = false, wrong = false;
    for (const LocatedPart& found : located.found.parts) {
      const auto& own = bench_.machine().pipeline.models()[static_cast<std::size_t>(found.template_index)];
      if ((found.T_camera_part * own.centre_mm - truth * model.centre_mm).norm() > 0.25 * model.diagonal_mm) continue;
      const GraspError error = grasp_error(found.T_camera_part, truth, model, 0);
      rows_[0].off_mm.push_back(error.mm);
      (found.template_index == model_index && !error.wrong() ? right : wrong) = true;
    }
    Row& row = rows_[0];
    ++(right ? row.right : wrong ? row.wrong : row.none);
    const auto& tried = located.found.tried;
    const auto at = std::find(tried.begin(), tried.end(), segment) - tried.begin();
    if (at < std::ssize(tried)) row.ms.push_back(located.found.object_ms[static_cast<std::size_t>(at)]);
  }

  void run_peers(const SceneBench::Scene& scene, std::uint16_t segment, int part, int model_index,
                 const PartPose& truth) {
    const PartModel& model = bench_.machine().pipeline.models()[static_cast<std::size_t>(model_index)];
    PeerObject object;
    object.part = &pool_.templates[static_cast<std::size_t>(part)];
    object.sample.resize(2 * kSample);
    pipeline::Object labelled;
    labelled.add(scene.located.objects.segments[segment - 1U]);  // label i + 1 stands at i
    object.sample.resize(std::min(kSample, pipeline::sample_object(scene.seen.range, scene.located.objects.labels,
                                                                   labelled, kSample, 1, object.sample)));
    const Stopwatch searching;
    object.starts = starts(object, model);
    const double search_ms = searching.elapsed_ms();
    search_ms_.push_back(search_ms);
    const auto enter = [&](Row& row, double more_ms, auto&& solve) {
      const Stopwatch watch;
      const PeerFit fit = solve();
      row.ms.push_back(watch.elapsed_ms() + more_ms);
      const GraspError error = grasp_error(fit.T_camera_part, truth, model, 0);
      row.off_mm.push_back(error.mm);
      ++(error.wrong() ? row.wrong : row.right);
    };
    enter(rows_[1], search_ms, [&] { return object.starts.empty() ? PeerFit{} : vtk_icp(object); });
    enter(rows_[2], search_ms, [&] { return pcl_icp(object); });
    const OpencvPpf& detector = detectors_.at(part);
    const Stopwatch voting;
    PeerObject proposed = object;
    proposed.starts = detector.propose(object, kProposed);
    const double voting_ms = voting.elapsed_ms();
    enter(rows_[3], voting_ms,
          [&] { return proposed.starts.empty() ? PeerFit{} : detector.refine(object, proposed.starts); });
    enter(rows_[4], voting_ms, [&] { return pcl_icp(proposed); });
  }

  static std::vector<PartPose> starts(const PeerObject& object, const PartModel& model) {
    std::vector<Hypothesis> storage(400), best(kStarts);
    search::HypothesisPool pool(storage);
    const std::span<const OrientedPoint> sample(object.sample.data(), std::min(kSearchSample, object.sample.size()));
    search::search_views({model, search::SearchSample(sample), static_cast<float>(0.08 * model.diagonal_mm)}, pool);
    best.resize(pool.take_distinct(model, 0.03 * model.diagonal_mm, 0.15, best));
    std::vector<PartPose> poses;
    for (const Hypothesis& hypothesis : best) poses.push_back(hypothesis.T_camera_part);
    return poses;
  }

  const Options& options_;
  const PartPool& pool_;
  SceneBench bench_;
  std::map<int, OpencvPpf> detectors_;
  std::vector<double> search_ms_;
  int objects_ = 0;
  std::vector<Row> rows_{{"beltpick", 0, 0, 0, {}, {}},
                         {"VTK ICP, the paper's settings", 0, 0, 0, {}, {}},
                         {"PCL ICP, point to plane", 0, 0, 0, {}, {}},
                         {"OpenCV PPF, its own ICP", 0, 0, 0, {}, {}},
                         {"OpenCV PPF, then PCL ICP", 0, 0, 0, {}, {}}};
};

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  return beltpick::bench::run_scene_loop<beltpick::bench::Contest>("bench_pose_peers", argc, argv);
}
