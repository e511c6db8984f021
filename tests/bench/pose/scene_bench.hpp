// SceneBench: scene number k of a run, laid, seen and located.
#pragma once

#include <vector>

#include "bench/pose/belt_camera.hpp"
#include "bench/pose/options.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::bench {

class SceneBench {
 public:
  // Keeps a reference to the pool. Throws std::runtime_error where the options name what there is not.
  SceneBench(const Options& options, const PartPool& pool);

  // The views stay good until the next call.
  struct Scene {
    ScenePlan plan;
    SeenScene seen;
    pipeline::Located located;            // its times are the least of all repeats
    double making_ms = 0.0;               // wall time until there was a range image
    std::vector<double> least_object_ms;  // what located.found.object_ms shows
  };
  Scene run(int k);
  // What will lie in it, and what will be loaded.
  [[nodiscard]] ScenePlan plan(int k) const { return plan_scene(pool_, plan_options_, k); }

  [[nodiscard]] const Machine& machine() const { return machine_; }
  [[nodiscard]] const Calibration& calibration() const { return camera_.calibration(); }

 private:
  void load(const std::vector<int>& templates);
  void locate(Scene& scene);

  const PartPool& pool_;
  PlanOptions plan_options_;
  BeltCamera camera_;
  Machine machine_;
  int repeats_;
  std::vector<int> loaded_;
};

}  // namespace beltpick::bench
