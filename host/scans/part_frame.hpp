// The frame in which a part taught from scans is described.
#pragma once

#include "contract/mesh.hpp"
#include "scans/scan_view.hpp"

namespace beltpick::scans {

// The part as it lay in the first scan: z up from the belt, the origin on the belt below the middle of the part's box,
// x along its greatest horizontal extent (the first principal axis of the surface, to the right in the image), y so
// that the frame is right-handed. Without a belt z points to the first camera and the origin is the box's middle.
//
// `surface` lies in the first scan's camera frame. Returns the motion from there to the part frame.
Pose<frame::Part, frame::Part> part_frame(const Mesh& surface, const ScanView& first);

}  // namespace beltpick::scans
