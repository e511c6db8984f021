// Writes what a renderer sees as a CAPTURE with its truth.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "base/result.hpp"
#include "contract/capture.hpp"
#include "contract/truth.hpp"
#include "virtual_cell/render/belt_part.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::virtual_cell {

// Where in the sequence's time the camera stands: the belt stopped settle_s before the first frame.
struct CaptureTiming {
  double settle_s = 0.25;
  double frame_rate_hz = 60.0;
};

// The instances of a scene for the renderer.
std::vector<PartInstance> instances_of(const Scene& scene, const Rig& rig);

// The truth of what the renderer has placed.
Truth truth_of(const SceneRenderer& renderer, std::span<const PartInstance> instances,
               std::span<const ScenePart> parts);

// Exposes the sequence (each frame for its exposure_us, or the nominal one) and writes frames, truth and, last,
// capture.json into `folder`, which is made. `done` is told each frame. Errors: kFileNotWritten.
Result<void> write_capture_folder(SceneRenderer& renderer, const RenderOptions& options, const Sequence& sequence,
                                  const Truth& truth, const CaptureTiming& timing, const std::filesystem::path& folder,
                                  const std::function<void()>& done);

}  // namespace beltpick::virtual_cell
