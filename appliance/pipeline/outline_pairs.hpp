// Where the measured object ends, against where the drawn part ends.
#pragma once

#include <cstdint>
#include <span>

#include "icp/align.hpp"
#include "result/drawing.hpp"
#include "result/scene.hpp"

namespace beltpick::pipeline {

// What must lie beyond the object's end for the end to count: anything that does not hide the object, or only what
// tells for certain that the object ends there: something measured farther away, or nothing where the light would have
// reached the object, did it go on. Nothing measured anywhere else may be a shadow cast on the object.
enum class Borders : std::uint8_t { kAny, kCertain };

// Walks across the drawn outline in the image, up to `reach_mm` to either side, and pairs each place with the last
// measured pixel of the object. `step_mm`: what parts surfaces in depth. `spacing_mm`: of the part's points. Places
// where the object is hidden by something in front are left out. Returns how many pairs were written to `out`, at most
// about one a cell of the outline.
std::size_t pair_outline(const result::Drawing& drawing, const result::PartPose& T_camera_part,
                         const result::Scene& scene, double spacing_mm, double reach_mm, double step_mm,
                         std::span<icp::OutlinePair> out, Borders borders = Borders::kAny);

}  // namespace beltpick::pipeline
