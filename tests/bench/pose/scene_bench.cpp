#include "bench/pose/scene_bench.hpp"

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
      machine_(limits_of(options), options.workers) {
  for (const std::string& kind : options.kinds) plan_options_.kinds.push_back(scene_kind(kind));
}

SceneBench::Scene SceneBench::run(int k) {
  Scene scene;
  scene.plan = plan(k);
  load(scene.plan.loaded);
  const Stopwatch watch;
  scene.seen = camera_.look(scene.plan, machine_);
  scene.making_ms = watch.elapsed_ms();
  const Calibration& calibration = camera_.calibration();
  scene.located = need(machine_.pipeline.locate(
      {scene.seen.range, calibration.camera, pipeline::projector_position_mm(calibration), 1}));
  return scene;
}

void SceneBench::load(const std::vector<int>& templates) {
  if (templates == loaded_) return;
  std::vector<PartTemplate> parts;
  for (const int index : templates) parts.push_back(pool_.templates[static_cast<std::size_t>(index)]);
  need(machine_.pipeline.load(parts));
  loaded_ = templates;
}

}  // namespace beltpick::bench
