#include "bench/pose/scene_bench.hpp"

#include <algorithm>

#include "base/clock.hpp"
#include "bench/pose/need.hpp"

namespace beltpick::bench {
namespace {

Limits limits_of(const Options& options) {
  Limits limits;
  limits.image_width = options.width;
  limits.image_height = options.height;
  return limits;
}

}  // namespace

SceneBench::SceneBench(const Options& options, const PartPool& pool)
    : pool_(pool),
      plan_options_{options.seed, options.rendered_every, {}, options.parts},
      camera_(pool, options.width, options.height, options.noise_mm),
      machine_(limits_of(options), options.workers),
      repeats_(options.repeats) {
  for (const std::string& kind : options.kinds) plan_options_.kinds.push_back(scene_kind(kind));
}

SceneBench::Scene SceneBench::run(int k) {
  Scene scene;
  scene.plan = plan(k);
  load(scene.plan.loaded);
  const Stopwatch watch;
  scene.seen = camera_.look(scene.plan, machine_);
  scene.making_ms = watch.elapsed_ms();
  locate(scene);
  return scene;
}

// The same input gives the same poses in the same order: what differs between repeats is what else the machine does.
void SceneBench::locate(Scene& scene) {
  const Calibration& calibration = camera_.calibration();
  const pipeline::View view{scene.seen.range, calibration.camera, pipeline::projector_position_mm(calibration), 1};
  for (int repeat = 0; repeat < repeats_; ++repeat) {
    const pipeline::Located before = scene.located;
    scene.located = need(machine_.pipeline.locate(view));
    const auto& object_ms = scene.located.found.object_ms;
    if (repeat == 0) scene.least_object_ms.assign(object_ms.begin(), object_ms.end());
    for (std::size_t i = 0; i < object_ms.size(); ++i)
      scene.least_object_ms[i] = std::min(scene.least_object_ms[i], object_ms[i]);
    if (repeat == 0) continue;
    scene.located.segment_ms = std::min(scene.located.segment_ms, before.segment_ms);
    scene.located.locate_ms = std::min(scene.located.locate_ms, before.locate_ms);
  }
  scene.located.found.object_ms = scene.least_object_ms;
}

void SceneBench::load(const std::vector<int>& templates) {
  if (templates == loaded_) return;
  std::vector<PartTemplate> parts;
  for (const int index : templates) parts.push_back(pool_.templates[static_cast<std::size_t>(index)]);
  need(machine_.pipeline.load(parts));
  loaded_ = templates;
}

}  // namespace beltpick::bench
