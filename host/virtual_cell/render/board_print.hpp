// BoardPrint: the dark print of a calibration plate, and how much of it a pixel sees.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace beltpick::virtual_cell {

// A chessboard, or a ChArUco board: the same with a marker of DICT_4X4_100 at 0.75 of the square's side in each light
// square, numbered row after row.
struct Board {
  int columns = 11, rows = 8;  // inner corners
  double square_mm = 20.0;
  bool charuco = false;

  // Of the whole print, one square more than corners.
  [[nodiscard]] double width_mm() const { return (columns + 1) * square_mm; }
  [[nodiscard]] double height_mm() const { return (rows + 1) * square_mm; }
};

// The print lies in the plate's frame: origin at the first inner corner, x along the columns, y along the rows; the
// square before the first corner is dark.
class BoardPrint {
 public:
  // Errors: kValueOutOfRange for a board of less than 3 x 3 corners, of squares that are not 1..200 mm, or for a
  // ChArUco board of more markers than its dictionary has.
  static Result<BoardPrint> make(const Board& board);

  // Share of ink, 0..1, within a rectangle about a point of the plate: exact, for anti-aliased edges.
  [[nodiscard]] float ink_share(float x_mm, float y_mm, float width_x_mm, float width_y_mm) const;

 private:
  explicit BoardPrint(const Board& board);
  [[nodiscard]] bool inked(int column, int row) const;

  float module_mm_, origin_mm_;  // the print is a lattice of square modules, its corner at (origin, origin)
  int columns_, rows_;           // of modules
  std::vector<std::uint8_t> ink_;
};

}  // namespace beltpick::virtual_cell
