// What a template tells a search: where to begin, and how far to step.
#pragma once

#include "contract/part_model.hpp"
#include "contract/part_template.hpp"

namespace beltpick::pipeline {

// Fills the model's routes and steps; its primitives and its size are known. What the template does not tell is as the
// paper and the appliance's own measurements have it.
void plan_search(const PartTemplate& part, PartModel& model);

}  // namespace beltpick::pipeline
