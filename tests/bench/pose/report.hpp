// The table of a run, and its line of JSON.
#pragma once

#include <vector>

#include "bench/pose/fate_json.hpp"
#include "bench/pose/options.hpp"

namespace beltpick::bench {

// Whether what options.expect_recall asks for is so.
bool print_report(const Options& options, const std::vector<SceneRecord>& records);

}  // namespace beltpick::bench
