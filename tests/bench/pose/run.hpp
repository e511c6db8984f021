// Runs the scenes, on several processes, and keeps their records.
#pragma once

#include <vector>

#include "bench/pose/fate_json.hpp"
#include "bench/pose/options.hpp"

namespace beltpick::bench {

// In the order of the scenes. Tells on stderr how far it is and what was wrong or missed.
std::vector<SceneRecord> run_scenes(const Options& options, const PartPool& pool);

}  // namespace beltpick::bench
