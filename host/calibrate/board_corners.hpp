// Finds the printed corners of a chessboard or ChArUco plate in a camera image.
#pragma once

#include <vector>

#include "base/image.hpp"
#include "base/result.hpp"
#include "calibrate/observations.hpp"

namespace beltpick::calibrate {

struct FoundCorner {
  int corner = 0;  // row * columns + column
  PixelPosition at_px;
};

// The corners of `board` in `image` (levels 0..255), sub-pixel. A chessboard is found only as a whole, a ChArUco board
// also in part. The plate's axes are right-handed with z into the plate. Of the ways to number a chessboard the one is
// taken that has a dark square between its first four corners; where both ends look alike (columns + rows even), the
// one whose first row runs rightwards in the image. Errors: kNothingFound; kValueOutOfRange for a board that cannot be.
Result<std::vector<FoundCorner>> find_board(const Board& board, ImageView<const float> image);

// Whether the board looks the same after half a turn, so that its corners can be numbered either way.
bool is_symmetric(const Board& board);

// Whether `board` can be looked for: sizes, and a dictionary that is known. Error: kValueOutOfRange.
Result<void> check_board(const Board& board);

// The distance to the nearest found neighbour in the board's lattice, in pixels, by place in `corners`; the mean of the
// others where a corner has no neighbour.
std::vector<double> corner_spacing_px(const Board& board, const std::vector<FoundCorner>& corners);

}  // namespace beltpick::calibrate
