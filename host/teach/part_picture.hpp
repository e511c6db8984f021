// A shaded picture of a part's surface points, its primitives in colour and its grasps drawn in.
#pragma once

#include <vector>

#include "contract_io/image_io.hpp"
#include "teach/teach.hpp"

namespace beltpick::teach {

struct Picture {
  int rows = 0;
  int cols = 0;
  std::vector<contract_io::Rgb> pixels;
};

// The colour in which primitive `index` is drawn.
contract_io::Rgb primitive_colour(std::size_t index);

// The part seen along `direction` (part frame), orthographic, filling the picture.
Picture draw_part(const Taught& taught, const Vec3& direction, int rows, int cols);

}  // namespace beltpick::teach
