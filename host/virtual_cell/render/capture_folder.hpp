// Writes what a renderer sees as a CAPTURE with its truth.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "base/result.hpp"
#include "contract/capture.hpp"
#include "contract/truth.hpp"
#include "virtual_cell/render/belt_part.hpp"
#include "virtual_cell/render/capture_faults.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::virtual_cell {

// How the capture runs: the belt stopped settle_s before the first frame; what goes wrong with its images.
struct CaptureTiming {
  double settle_s = 0.25;
  double frame_rate_hz = 60.0;
  CaptureFaults faults;
};

// The instances of a scene for the renderer.
std::vector<PartInstance> instances_of(const Scene& scene, const Rig& rig);

// The truth of what the renderer has placed.
Truth truth_of(const SceneRenderer& renderer, std::span<const PartInstance> instances,
               std::span<const ScenePart> parts);

// Exposes the sequence (each frame for its exposure_us, or the nominal one) and writes frames, truth and, last,
// capture.json into `folder`, which is made. `done` is told each frame. The truth is that of the first frame. Errors:
// kFileNotWritten, kUsage for faults beyond the sequence.
Result<void> write_capture_folder(SceneRenderer& renderer, const RenderOptions& options, const Sequence& sequence,
                                  const Truth& truth, const CaptureTiming& timing, const std::filesystem::path& folder,
                                  const std::function<void()>& done);

}  // namespace beltpick::virtual_cell
