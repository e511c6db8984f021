// Without a calibration, pixels between two depths are masked by their coordinates alone.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "range/code_edges.hpp"

namespace beltpick::testing {
namespace {

constexpr int kRows = 24;
constexpr int kCols = 32;

// A coordinate that runs over a belt, higher on what is nearer.
struct CodeCanvas {
  std::vector<float> column_px, modulation;
  std::vector<std::uint8_t> texture;
  std::vector<PixelState> state;

  CodeCanvas()
      : modulation(kRows * kCols, 60.0F), texture(kRows * kCols, 120), state(kRows * kCols, PixelState::kValid) {
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kCols; ++c) {
        column_px.push_back(300.0F + 0.7F * static_cast<float>(c) - 0.05F * static_cast<float>(r));
      }
    }
  }
  void lift(int row, int col, float by_px) { column_px[static_cast<std::size_t>(row * kCols + col)] += by_px; }
  [[nodiscard]] PixelState at(int row, int col) const { return state[static_cast<std::size_t>(row * kCols + col)]; }
  int mask() {
    CodeImage code;
    code.column_px = {column_px.data(), kRows, kCols};
    code.modulation = {modulation.data(), kRows, kCols};
    code.texture = {texture.data(), kRows, kCols};
    code.state = {state.data(), kRows, kCols};
    code.column_noise = {.floor_px = 0.0F, .slope_px = 1.0F};
    Arena measuring;
    { const range::CodeEdges edges(measuring, kCols); }
    ArenaBlock block(measuring.used_bytes());
    Arena arena(block.data(), block.bytes());
    return range::CodeEdges(arena, kCols).mask(code);
  }
};

TEST_CASE("a coordinate between two depths is masked, those beside it are not") {
  CodeCanvas canvas;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < 12; ++c) canvas.lift(r, c, 40.0F);
    canvas.lift(r, 12, 17.0F);
  }
  CHECK(canvas.mask() == kRows);
  for (int r = 0; r < kRows; ++r) {
    for (const int c : {0, 10, 11, 13, 31}) CHECK(canvas.at(r, c) == PixelState::kValid);
    CHECK(canvas.at(r, 12) == PixelState::kEdge);
  }
}

TEST_CASE("slopes and gaps of a coordinate are no edges, and masked pixels keep their reason") {
  CodeCanvas canvas;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 16; c < kCols; ++c) canvas.lift(r, c, 0.9F * static_cast<float>(c - 16));
    for (int c = 4; c < 8; ++c) {
      canvas.column_px[static_cast<std::size_t>(r * kCols + c)] = NAN;
      canvas.state[static_cast<std::size_t>(r * kCols + c)] = PixelState::kDark;
    }
  }
  CHECK(canvas.mask() == 0);
  CHECK(canvas.at(9, 5) == PixelState::kDark);
}

}  // namespace
}  // namespace beltpick::testing
