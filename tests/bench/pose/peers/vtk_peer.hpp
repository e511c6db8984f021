// VTK's vtkIterativeClosestPointTransform with the paper's settings: 1000 points of the object against all of the
// template, at most 200 iterations.
#pragma once

#include "bench/pose/peers/peer_object.hpp"

namespace beltpick::bench {

// From the first start alone, as the paper does.
PeerFit vtk_icp(const PeerObject& object);

}  // namespace beltpick::bench
