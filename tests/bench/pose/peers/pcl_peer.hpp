// PCL's ICP, point to plane, with two correspondence distances, the wide one first.
#pragma once

#include "bench/pose/peers/peer_object.hpp"

namespace beltpick::bench {

// The best fit of those from all starts.
PeerFit pcl_icp(const PeerObject& object);

}  // namespace beltpick::bench
