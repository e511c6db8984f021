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

// The colour in which primitive `index` is drawn; cones come after the primitives.
contract_io::Rgb primitive_colour(std::size_t index);

// How a picture is looked at: rows of the matrix are the picture's right, its down and the line of sight, part frame.
Mat3 looking_along(const Vec3& direction);

// A colour for each of the part's points: that of its primitive or cone, ..
std::vector<contract_io::Rgb> colours_of_primitives(const Taught& taught);
// .. or red for those marked.
std::vector<contract_io::Rgb> colours_of_marks(const std::vector<bool>& marked);

// The part, orthographic, filling the picture. `colours`: one a point. Draws the first `grasps` grasps.
Picture draw_part(const Taught& taught, const Mat3& looking, const std::vector<contract_io::Rgb>& colours,
                  std::size_t grasps, int rows, int cols);

}  // namespace beltpick::teach
