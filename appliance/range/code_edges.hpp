// Edges of a code image without a calibration: flying pixels are looked for among projector coordinates.
#pragma once

#include "base/arena.hpp"
#include "base/stages.hpp"
#include "range/edge_filter.hpp"

namespace beltpick::range {

// The coordinate less its median slope over the image changes with depth alone; what a surface may climb from pixel to
// pixel is told by that slope too. Edges along which the coordinate runs on stay unseen.
class CodeEdges {
 public:
  CodeEdges(Arena& arena, int cols);

  // Calls valid pixels that fly kEdge in code.state (by the columns where both axes are coded). Returns how many.
  int mask(const CodeImage& code);

 private:
  EdgeFilter filter_;
  std::span<float> depth_, sigma_;
};

}  // namespace beltpick::range
