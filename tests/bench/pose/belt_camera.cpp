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

BeltCamera::BeltCamera(const PartPool& pool, int width, int height, double noise_mm)
    : pool_(pool),
      noise_mm_(noise_mm),
      rig_(rig_with(width, height)),
      calibration_(vc::calibrate_rig(rig_).calibration),
      sequence_(need(make_sequence(SequenceName::kStandard, {rig_.projector.width, rig_.projector.height, rig_.layout},
                                   SequenceAxes::kColumn))),
      maker_(pool.parts, rig_),
      caster_(rig_, pool.parts, calibration_, sequence_),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

SeenScene BeltCamera::look(const ScenePlan& plan, Machine& machine) {
  return look(maker_.make(std::span(plan.lays), plan.scene_seed), plan.scene_seed,
              plan.rendered ? Seeing::kRendered : Seeing::kCast, machine);
}

SeenScene BeltCamera::look(const vc::Scene& scene, std::uint64_t seed, Seeing seeing, Machine& machine) {
  const auto instances = vc::instances_of(scene, rig_);
  SeenScene seen;
  for (const vc::BeltPart& placed : scene) seen.part.push_back(placed.part);
  std::vector<double> visible;
  if (seeing == Seeing::kRendered) {
    seen.range = render(instances, seed, machine);
    seen.instances = renderer_->true_instances();
    visible = renderer_->visible_fractions();
  } else {
    seen.range = noise_mm_ > 0.0 ? caster_.cast_points(instances, seed, noise_mm_) : caster_.cast(instances, seed);
    seen.instances = caster_.instances();
    visible = caster_.visible_fractions();
  }
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const vc::ScenePart& part = pool_.parts[static_cast<std::size_t>(seen.part[i])];
    seen.truth.parts.push_back({part.name, instances[i].T_camera_part, visible[i], part.symmetries});
  }
  return seen;
}

RangeImage BeltCamera::render(std::span<const vc::PartInstance> instances, std::uint64_t seed, Machine& machine) {
  if (!renderer_) renderer_ = std::make_unique<vc::SceneRenderer>(rig_, pool_.parts);
  renderer_->place(instances, seed);
  need(machine.measure.configure(sequence_, calibration_));
  need(machine.measure.begin());
  const vc::CaptureTiming timing;
  for (std::size_t i = 0; i < sequence_.frames.size(); ++i) {
    const ImageView<std::uint8_t> image(pixels_.data(), rig_.camera.height, rig_.camera.width);
    renderer_->expose(sequence_.frames[i], vc::RenderOptions{}.nominal_exposure_us,
                      timing.settle_s + static_cast<double>(i) / timing.frame_rate_hz, image);
    need(machine.measure.fold(static_cast<int>(i), ImageView<const std::uint8_t>(image)));
  }
  return need(machine.measure.finish());
}

}  // namespace beltpick::bench
