#include "bench/pose/belt_camera.hpp"

#include "bench/pose/need.hpp"
#include "contract/sequences.hpp"
#include "virtual_cell/render/capture_folder.hpp"
#include "virtual_cell/render/rig_calibration.hpp"

namespace beltpick::bench {
namespace {

namespace vc = virtual_cell;

vc::Rig rig_with(int width, int height) {
  vc::RigOptions options;
  options.camera_width = width;
  options.camera_height = height;
  return need(vc::make_rig(options));
}

}  // namespace

BeltCamera::BeltCamera(const PartPool& pool, int width, int height)
    : pool_(pool),
      rig_(rig_with(width, height)),
      calibration_(vc::calibrate_rig(rig_).calibration),
      sequence_(need(make_sequence(SequenceName::kStandard, {rig_.projector.width, rig_.projector.height, rig_.layout},
                                   SequenceAxes::kColumn))),
      maker_(pool.parts, rig_),
      renderer_(std::make_unique<vc::SceneRenderer>(rig_, pool.parts)),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

SeenScene BeltCamera::look(const ScenePlan& plan, Machine& machine) {
  const vc::Scene scene = maker_.make(std::span(plan.lays), plan.scene_seed);
  const auto instances = vc::instances_of(scene, rig_);
  renderer_->place(instances, plan.scene_seed);
  SeenScene seen;
  seen.truth = vc::truth_of(*renderer_, instances, pool_.parts);
  for (const vc::BeltPart& placed : scene) seen.part.push_back(placed.part);
  seen.instances = renderer_->true_instances();
  need(machine.measure.configure(sequence_, calibration_));
  need(machine.measure.begin());
  const vc::CaptureTiming timing;
  for (std::size_t i = 0; i < sequence_.frames.size(); ++i) {
    const ImageView<std::uint8_t> image(pixels_.data(), seen.instances.rows, seen.instances.cols);
    renderer_->expose(sequence_.frames[i], vc::RenderOptions{}.nominal_exposure_us,
                      timing.settle_s + static_cast<double>(i) / timing.frame_rate_hz, image);
    need(machine.measure.fold(static_cast<int>(i), ImageView<const std::uint8_t>(image)));
  }
  seen.range = need(machine.measure.finish());
  return seen;
}

}  // namespace beltpick::bench
