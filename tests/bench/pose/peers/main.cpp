// bench_pose_peers: the product beside VTK's ICP, PCL's ICP and OpenCV's point pair features, on the same objects of
// the same scenes, one thread each. Run by `bench_pose --peers`; takes its options.
//
// An object is what the product's segmenter made of the image: of every part of which half was measured, the segment
// that shows most of it. The peers get 1000 of its points with normals and the template. VTK and PCL need a start: they
// get the best of the product's search over all views of the part (162 views x 24 turns, as the paper's search but
// finer): VTK, as in the paper, the best one; PCL the best three, and keeps what fits best. That search's time is
// counted for them. The peers always answer; the product may withhold. Errors count at the part's first grasp.
#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/clock.hpp"
#include "bench/pose/judge.hpp"
#include "bench/pose/need.hpp"
#include "bench/pose/options.hpp"
#include "bench/pose/peers/opencv_peer.hpp"
#include "bench/pose/peers/pcl_peer.hpp"
#include "bench/pose/peers/vtk_peer.hpp"
#include "pipeline/object_points.hpp"
#include "search/views.hpp"

namespace beltpick::bench {
namespace {

constexpr std::size_t kSample = 1000;       // the paper's
constexpr std::size_t kSearchSample = 100;  // the paper's
constexpr std::size_t kStarts = 3;
constexpr double kLeastMeasured = 0.5;

struct Row {
  const char* name;
  int right = 0, wrong = 0, none = 0;
  std::vector<double> ms;
};

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

// Of a true part: how many of its pixels were measured, and the segment that shows most of it.
struct Shown {
  int pixels = 0, measured = 0;
  const Segment* segment = nullptr;
};
Shown shown(const SeenScene& seen, const pipeline::Located& located, int i) {
  std::map<int, int> count;
  Shown result;
  for (int row = 0; row < seen.instances.rows; ++row) {
    for (int col = 0; col < seen.instances.cols; ++col) {
      if (seen.instances(row, col) != i + 1) continue;
      ++result.pixels;
      result.measured += seen.range.valid(row, col) ? 1 : 0;
      if (located.objects.labels(row, col) > 0) ++count[located.objects.labels(row, col)];
    }
  }
  const auto most = std::max_element(count.begin(), count.end(), [](auto& a, auto& b) { return a.second < b.second; });
  for (const Segment& segment : located.objects.segments) {
    if (most != count.end() && segment.label == most->first) result.segment = &segment;
  }
  return result;
}

class Contest {
 public:
  Contest(const Options& options, const PartPool& pool)
      : options_(options),
        pool_(pool),
        camera_(pool, options.width, options.height, options.noise_mm),
        machine_(limits(options)) {
    plan_options_ = {options.seed, options.rendered_every, {}, options.parts};
    for (const std::string& kind : options.kinds) plan_options_.kinds.push_back(scene_kind(kind));
  }

  void run() {
    for (int k = options_.first_scene; k < options_.first_scene + options_.scenes; ++k) {
      scene(k);
      std::fprintf(stderr, "\r%d/%d", k - options_.first_scene + 1, options_.scenes);
    }
    std::fputs("\r", stderr);
  }

  void print() const {
    nlohmann::json line{{"seed", options_.seed},
                        {"scenes", options_.scenes},
                        {"objects", objects_},
                        {"start_search_ms", quantile(search_ms_, 0.5)}};
    std::printf("%d objects; starts for VTK and PCL: %.1f ms (median), counted in their times\n", objects_,
                quantile(search_ms_, 0.5));
    std::printf("%-34s %7s %7s %8s  %12s %12s\n", "", "right", "wrong", "withheld", "median ms", "99 % ms");
    for (const Row& row : rows_) {
      std::printf("%-34s %5.1f %% %7d %8d  %12.1f %12.1f\n", row.name, 100.0 * row.right / std::max(1, objects_),
                  row.wrong, row.none, quantile(row.ms, 0.5), quantile(row.ms, 0.99));
      line["methods"][row.name] = {{"right", row.right},
                                   {"wrong", row.wrong},
                                   {"withheld", row.none},
                                   {"median_ms", quantile(row.ms, 0.5)},
                                   {"p99_ms", quantile(row.ms, 0.99)}};
    }
    std::printf("%s\n", line.dump().c_str());
  }

 private:
  static Limits limits(const Options& options) {
    Limits limits;
    limits.image_width = options.width;
    limits.image_height = options.height;
    return limits;
  }

  void scene(int k) {
    const ScenePlan plan = plan_scene(pool_, plan_options_, k);
    if (plan.loaded != loaded_) {
      std::vector<PartTemplate> templates;
      for (const int index : plan.loaded) templates.push_back(pool_.templates[static_cast<std::size_t>(index)]);
      need(machine_.pipeline.load(templates));
      loaded_ = plan.loaded;
    }
    const SeenScene seen = camera_.look(plan, machine_);
    const auto located = need(machine_.pipeline.locate(
        {seen.range, camera_.calibration().camera, pipeline::projector_position_mm(camera_.calibration()), 1}));
    for (std::size_t i = 0; i < seen.truth.parts.size(); ++i) {
      const auto at = std::find(plan.loaded.begin(), plan.loaded.end(), seen.part[i]);
      const Shown here = shown(seen, located, static_cast<int>(i));
      const bool counts = here.segment != nullptr && here.measured >= kLeastMeasured * here.pixels &&
                          seen.truth.parts[i].visible_fraction * here.measured >= kLeastMeasured * here.pixels;
      if (at == plan.loaded.end() || !counts) continue;
      ++objects_;
      const auto model_index = static_cast<int>(at - plan.loaded.begin());
      const PartModel& model = machine_.pipeline.models()[static_cast<std::size_t>(model_index)];
      judge_product(located, model_index, seen.truth.parts[i].T_camera_part, *here.segment);
      run_peers(seen, located, *here.segment, seen.part[i], model, seen.truth.parts[i].T_camera_part);
    }
  }

  // Right or wrong by the pose offered that lies nearest to the part, within half its size.
  void judge_product(const pipeline::Located& located, int model_index, const PartPose& truth, const Segment& segment) {
    const PartModel& model = machine_.pipeline.models()[static_cast<std::size_t>(model_index)];
    bool right = false, wrong = false;
    for (const LocatedPart& found : located.found.parts) {
      const auto& own = machine_.pipeline.models()[static_cast<std::size_t>(found.template_index)];
      if ((found.T_camera_part * own.centre_mm - truth * model.centre_mm).norm() > 0.25 * model.diagonal_mm) continue;
      const bool true_pose =
          found.template_index == model_index && !grasp_error(found.T_camera_part, truth, model, 0).wrong();
      (true_pose ? right : wrong) = true;
    }
    Row& row = rows_[0];
    ++(right ? row.right : wrong ? row.wrong : row.none);
    const auto& tried = located.found.tried;
    const auto at = std::find(tried.begin(), tried.end(), segment.label) - tried.begin();
    if (at < std::ssize(tried)) row.ms.push_back(located.found.object_ms[static_cast<std::size_t>(at)]);
  }

  void run_peers(const SeenScene& seen, const pipeline::Located& located, const Segment& segment, int part,
                 const PartModel& model, const PartPose& truth) {
    PeerObject object;
    object.part = &pool_.templates[static_cast<std::size_t>(part)];
    object.sample.resize(2 * kSample);
    pipeline::Object labelled;
    labelled.add(segment);
    object.sample.resize(std::min(
        kSample, pipeline::sample_object(seen.range, located.objects.labels, labelled, kSample, 1, object.sample)));
    const Stopwatch searching;
    object.starts = starts(object, model);
    const double search_ms = searching.elapsed_ms();
    search_ms_.push_back(search_ms);
    auto detector = detectors_.find(part);
    if (detector == detectors_.end()) detector = detectors_.emplace(part, OpencvPpf(*object.part)).first;
    const auto enter = [&](Row& row, double more_ms, auto&& solve) {
      const Stopwatch watch;
      const PeerFit fit = solve();
      row.ms.push_back(watch.elapsed_ms() + more_ms);
      ++(grasp_error(fit.T_camera_part, truth, model, 0).wrong() ? row.wrong : row.right);
    };
    enter(rows_[1], search_ms, [&] { return object.starts.empty() ? PeerFit{} : vtk_icp(object); });
    enter(rows_[2], search_ms, [&] { return pcl_icp(object); });
    enter(rows_[3], 0.0, [&] { return detector->second.match(object); });
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
  PlanOptions plan_options_;
  BeltCamera camera_;
  Machine machine_;
  std::vector<int> loaded_;
  std::map<int, OpencvPpf> detectors_;
  std::vector<double> search_ms_;
  int objects_ = 0;
  std::vector<Row> rows_{{"beltpick", 0, 0, 0, {}},
                         {"VTK ICP, the paper's settings", 0, 0, 0, {}},
                         {"PCL ICP, point to plane", 0, 0, 0, {}},
                         {"OpenCV PPF and its ICP", 0, 0, 0, {}}};
};

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  using namespace beltpick::bench;
  try {
    const Options options = read_options(argc, argv);
    const PartPool pool = make_part_pool(options.families, options.templates);
    Contest contest(options, pool);
    contest.run();
    contest.print();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_pose_peers: %s\n", error.what());
    return 1;
  }
}
