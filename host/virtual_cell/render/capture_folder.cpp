#include "virtual_cell/render/capture_folder.hpp"

#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/npy_io.hpp"
#include "contract_io/truth_io.hpp"

namespace beltpick::virtual_cell {
namespace {

Result<void> write_truth_files(const SceneRenderer& renderer, const Truth& truth, const std::filesystem::path& folder) {
  const auto points = renderer.true_points_mm();
  const auto instances = renderer.true_instances();
  const std::span<const float> xyz(points.data->data(), 3 * points.size());
  if (auto written = contract_io::write_npy(folder / truth.xyz_file, xyz, {points.rows, points.cols, 3}); !written)
    return written;
  const std::span<const std::uint16_t> labels(instances.data, instances.size());
  if (auto written = contract_io::write_npy(folder / truth.instances_file, labels, {points.rows, points.cols});
      !written)
    return written;
  return contract_io::write_truth(folder / "truth.json", truth);
}

}  // namespace

std::vector<PartInstance> instances_of(const Scene& scene, const Rig& rig) {
  std::vector<PartInstance> instances;
  for (const BeltPart& placed : scene) instances.push_back({placed.part, rig.T_camera_belt * placed.T_belt_part});
  return instances;
}

Truth truth_of(const SceneRenderer& renderer, std::span<const PartInstance> instances,
               std::span<const ScenePart> parts) {
  const std::vector<double> visible = renderer.visible_fractions();
  Truth truth;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const ScenePart& part = parts[instances[i].part];
    truth.parts.push_back({part.name, instances[i].T_camera_part, visible[i], part.symmetries});
  }
  return truth;
}

Result<void> write_capture_folder(SceneRenderer& renderer, const RenderOptions& options, const Sequence& sequence,
                                  const Truth& truth, const CaptureTiming& timing, const std::filesystem::path& folder,
                                  const std::function<void()>& done) {
  const int frames = static_cast<int>(sequence.frames.size());
  if (auto checked = timing.faults.check(frames); !checked) return checked;
  if (auto made = contract_io::make_folder(folder); !made) return made;
  // Without it no half-written mixture of an old capture and this one can be read.
  std::error_code none;
  std::filesystem::remove(folder / "capture.json", none);
  const auto size = renderer.true_instances();
  std::vector<std::uint8_t> pixels(size.size());
  CaptureHeader header;
  header.id = folder.filename().string();
  header.sequence = sequence;
  double time_s = timing.settle_s;
  for (int i = 0; i < frames; ++i) {
    FrameSpec& frame = header.sequence.frames[static_cast<std::size_t>(i)];
    if (frame.exposure_us <= 0.0) frame.exposure_us = options.nominal_exposure_us;
    const ImageView<std::uint8_t> image(pixels.data(), size.rows, size.cols);
    renderer.expose(timing.faults.shown(sequence, i), timing.faults.capped() ? 0.0 : frame.exposure_us, time_s, image,
                    timing.faults.belt_shift_mm(i, frames));
    if (auto written = contract_io::write_png(folder / frame.file, image); !written) return written;
    time_s += 1.0 / timing.frame_rate_hz;
    done();
  }
  if (auto written = write_truth_files(renderer, truth, folder); !written) return written;
  return contract_io::write_capture(folder / "capture.json", header);
}

}  // namespace beltpick::virtual_cell
