// Two poses that were each believed, or nearly: do they claim the same object, and which one is it?
#pragma once

#include <span>

#include "contract/part_model.hpp"
#include "pipeline/attempt.hpp"
#include "result/rivalry.hpp"
#include "result/scene.hpp"

namespace beltpick::pipeline {

// What of the image each of two poses explains, counted on every fourth row and column.
result::Rivalry contend(const Candidate& a, const Candidate& b, const result::Scene& scene,
                        std::span<const PartModel> models);

// Whether a pose is to be believed against a finished one that claims the same object. What a pose with blemishes
// explains as well, another may have; not what it explains better.
bool stands(const Candidate& champion, const Candidate& rival, const result::Rivalry& rivalry);

// Whether a pose found ambiguous in an earlier search lets `candidate` be doubted: it is the same one, or explains the
// same surface as well. A doubt does not end because a later search did not meet again what raised it; but whether what
// is in view holds the part, each search sees for itself.
bool doubted(const Candidate& candidate, const Attempt& ambiguous, const result::Scene& scene,
             std::span<const PartModel> models);

}  // namespace beltpick::pipeline
