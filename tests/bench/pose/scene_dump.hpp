// One scene of the bench as files: for `beltpick locate`, and for whoever asks why a pose is wrong.
#pragma once

#include <filesystem>

#include "bench/pose/belt_camera.hpp"
#include "bench/pose/fate_json.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::bench {

// Writes cloud.npy, sigma.npy, labels.npy, truth.json with its instances, calibration.json, the loaded templates,
// poses.txt (each pose found, 4x4) and fate.json (what the bench counts) into `folder`, which is made.
void write_scene(const std::filesystem::path& folder, const SeenScene& seen, const Calibration& calibration,
                 const std::vector<const PartTemplate*>& templates, const pipeline::Located& located,
                 const SceneRecord& record);

}  // namespace beltpick::bench
