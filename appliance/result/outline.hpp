// The outline of a drawn part in the image: does the object end where the part should?
#pragma once

#include "contract/part_model.hpp"
#include "result/drawing.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

// The share of the outline, where it can be judged, beyond which the same segment goes on in the same surface: near 0
// where the part is, near 1 where the pose merely fits inside something larger. 0 where too little can be judged.
double continued_outline(const Drawing& drawing, const PartModel& model, const PartPose& T_camera_part,
                         const Scene& scene, double tolerance_mm);

}  // namespace beltpick::result
