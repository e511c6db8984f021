// BeltCamera: the virtual cell's camera over a scene of the bench: renders every frame and folds it into the product's
// decoder, or casts the codes that decoding would give; and knows the truth.
#pragma once

#include <memory>
#include <vector>

#include "bench/pose/code_caster.hpp"
#include "bench/pose/machine.hpp"
#include "bench/pose/part_pool.hpp"
#include "bench/pose/scene_plan.hpp"
#include "contract/calibration.hpp"
#include "contract/truth.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::bench {

struct SeenScene {
  Truth truth;
  std::vector<int> part;                     // of the truth's parts, the index into the pool
  ImageView<const std::uint16_t> instances;  // of every pixel: 0 none, i the truth's part i - 1
  RangeImage range;
};

// How a scene becomes a range image: every frame exposed, folded and decoded, or the codes cast.
enum class Seeing : std::uint8_t { kRendered, kCast };

class BeltCamera {
 public:
  // `noise_mm`: of the points of scenes that are not rendered; 0: by the noise law.
  BeltCamera(const PartPool& pool, int width, int height, double noise_mm = 0.0);

  // The views stay good until the next call.
  SeenScene look(const ScenePlan& plan, Machine& machine);
  SeenScene look(const virtual_cell::Scene& scene, std::uint64_t seed, Seeing seeing, Machine& machine);

  [[nodiscard]] const Calibration& calibration() const { return calibration_; }
  [[nodiscard]] const virtual_cell::Rig& rig() const { return rig_; }
  [[nodiscard]] const virtual_cell::SceneMaker& maker() const { return maker_; }

 private:
  RangeImage render(std::span<const virtual_cell::PartInstance> instances, std::uint64_t seed, Machine& machine);

  const PartPool& pool_;
  double noise_mm_;
  virtual_cell::Rig rig_;
  Calibration calibration_;
  Sequence sequence_;
  virtual_cell::SceneMaker maker_;
  std::unique_ptr<virtual_cell::SceneRenderer> renderer_;  // made when first needed
  CodeCaster caster_;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace beltpick::bench
