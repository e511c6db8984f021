#include "virtual_cell/render/board_print.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr int kMarkerModules = 8;  // of a square of a ChArUco board: 1 light, 6 of the marker, 1 light
constexpr int kMarkerBits = 4;

// The codes of OpenCV's DICT_4X4_100, row after row from the top left, the first bit the most significant; 1 is light.
constexpr std::array<std::uint16_t, 100> kMarkers{
    0xb532, 0x0f9a, 0x332d, 0x9946, 0x549e, 0x79cd, 0x9e2e, 0xc4f2, 0xfeda, 0xcf56, 0xf991, 0x11a7, 0x0eb7,
    0x2a0f, 0x24b1, 0x263e, 0x4665, 0x6600, 0x6c5e, 0x76af, 0x868b, 0xb02b, 0xccd5, 0xdd82, 0xfe47, 0x9471,
    0xace4, 0xa554, 0x2123, 0x346f, 0x4415, 0x57b2, 0x9ecf, 0xf0cb, 0x08ae, 0x0929, 0x1875, 0x04ff, 0x0df6,
    0x1c5a, 0x1718, 0x2a28, 0x328c, 0x38b2, 0x24e8, 0x2eeb, 0x2d3f, 0x4b64, 0x502e, 0x5013, 0x5194, 0x5568,
    0x5d41, 0x5f97, 0x6801, 0x6867, 0x6124, 0x61e9, 0x6b12, 0x6fe5, 0x67df, 0x7e1b, 0x80a0, 0x8344, 0x8ba2,
    0x937a, 0x846c, 0x852a, 0x859c, 0x9c89, 0x9fa1, 0xbb7c, 0xbc04, 0xb65b, 0xbfc8, 0xb7ab, 0xca1f, 0xc962,
    0xd958, 0xd3d5, 0xcc98, 0xc7a0, 0xc537, 0xe95d, 0xf925, 0xfbbb, 0xee2a, 0xf74d, 0x3575, 0x8aad, 0x7617,
    0x0acf, 0x064b, 0x2dc1, 0x49d8, 0x43f4, 0x4f36, 0x4fd3, 0x69e4, 0x70c7};

bool marker_inked(int marker, int column, int row) {
  const int bit_column = column - 2;
  const int bit_row = row - 2;
  if (column < 1 || column > 6 || row < 1 || row > 6) return false;
  if (bit_column < 0 || bit_column >= kMarkerBits || bit_row < 0 || bit_row >= kMarkerBits) return true;
  const int shift = kMarkerBits * kMarkerBits - 1 - (bit_row * kMarkerBits + bit_column);
  return ((kMarkers[marker] >> shift) & 1) == 0;
}

// Length of what module `index` of a lattice shares with [low, high], both in modules.
float overlap(int index, float low, float high) {
  return std::max(0.0F, std::min(high, static_cast<float>(index + 1)) - std::max(low, static_cast<float>(index)));
}

}  // namespace

Result<BoardPrint> BoardPrint::make(const Board& board) {
  const int squares = (board.columns + 1) * (board.rows + 1);
  if (board.columns < 3 || board.rows < 3 || squares > 10'000)
    return failure(ResultCode::kValueOutOfRange, "board: expected 3x3 to 99x99 inner corners, found %dx%d; see --board",
                   board.columns, board.rows);
  if (!(board.square_mm >= 1.0 && board.square_mm <= 200.0))
    return failure(ResultCode::kValueOutOfRange, "board: expected squares of 1 to 200 mm, found %g; see --square-mm",
                   board.square_mm);
  if (board.charuco && squares / 2 > static_cast<int>(kMarkers.size()))
    return failure(ResultCode::kValueOutOfRange,
                   "board: expected at most %zu light squares for ChArUco markers, found %d; take fewer corners",
                   kMarkers.size(), squares / 2);
  return BoardPrint(board);
}

BoardPrint::BoardPrint(const Board& board) {
  const int side = board.charuco ? kMarkerModules : 1;
  module_mm_ = static_cast<float>(board.square_mm / side);
  origin_mm_ = static_cast<float>(-board.square_mm);
  columns_ = (board.columns + 1) * side;
  rows_ = (board.rows + 1) * side;
  ink_.resize(static_cast<std::size_t>(columns_) * rows_);
  int marker = 0;
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      const bool dark = (row + column) % 2 == 0;
      for (int i = 0; i < side * side; ++i) {
        const bool ink = dark || (board.charuco && marker_inked(marker, i % side, i / side));
        ink_[static_cast<std::size_t>(row * side + i / side) * columns_ + column * side + i % side] = ink ? 1 : 0;
      }
      if (!dark) ++marker;
    }
  }
}

bool BoardPrint::inked(int column, int row) const {
  return column >= 0 && column < columns_ && row >= 0 && row < rows_ &&
         ink_[static_cast<std::size_t>(row) * columns_ + column] != 0;
}

float BoardPrint::ink_share(float x_mm, float y_mm, float width_x_mm, float width_y_mm) const {
  const float left = (x_mm - origin_mm_ - 0.5F * width_x_mm) / module_mm_;
  const float right = (x_mm - origin_mm_ + 0.5F * width_x_mm) / module_mm_;
  const float top = (y_mm - origin_mm_ - 0.5F * width_y_mm) / module_mm_;
  const float bottom = (y_mm - origin_mm_ + 0.5F * width_y_mm) / module_mm_;
  float sum = 0.0F;
  for (int row = static_cast<int>(std::floor(top)); static_cast<float>(row) < bottom; ++row) {
    for (int column = static_cast<int>(std::floor(left)); static_cast<float>(column) < right; ++column) {
      if (inked(column, row)) sum += overlap(column, left, right) * overlap(row, top, bottom);
    }
  }
  return sum / ((right - left) * (bottom - top));
}

}  // namespace beltpick::virtual_cell
