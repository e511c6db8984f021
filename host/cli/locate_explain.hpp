// What `beltpick locate --explain` writes: the numbers and pictures behind every decision.
#pragma once

#include <string>
#include <vector>

#include "contract/part_template.hpp"
#include "pipeline/pipeline.hpp"
#include "range_input.hpp"

namespace beltpick::cli {

// Writes explain.json (an entry a found part: what the search began with, what alignment and verification measured; an
// entry a withheld object) and labels.png into the folder. Error: kFileNotWritten.
Result<void> explain(const std::string& folder, const pipeline::Located& located, const RangeInput& input,
                     const std::vector<PartTemplate>& templates);

}  // namespace beltpick::cli
