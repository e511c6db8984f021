// Flying pixels go, edges and thin parts stay.
#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "range/edge_filter.hpp"

namespace beltpick::testing {
namespace {

constexpr int kRows = 24;
constexpr int kCols = 32;
constexpr float kFocalPx = 2300.0F;

// Depths that a test paints, filtered.
struct Canvas {
  std::vector<float> depth_mm = std::vector<float>(kRows * kCols, 700.0F);
  std::vector<float> modulation = std::vector<float>(kRows * kCols, 60.0F);
  std::vector<std::uint8_t> flies;
  std::vector<float> sigma = std::vector<float>(kRows * kCols, 0.03F);

  float& at(int row, int col) { return depth_mm[static_cast<std::size_t>(row * kCols + col)]; }
  bool kept(int row, int col) { return flies[static_cast<std::size_t>(row * kCols + col)] == 0; }
  int filter() {
    Arena measuring;
    { const range::EdgeFilter filter(measuring, kCols); }
    ArenaBlock block(measuring.used_bytes());
    Arena arena(block.data(), block.bytes());
    range::EdgeFilter filter(arena, kCols);
    filter.begin(kCols, kFocalPx);
    flies.clear();
    for (std::size_t at = 0; at < depth_mm.size(); at += kCols) {
      const auto judged = filter.push(&depth_mm[at], &sigma[at], &modulation[at]);
      flies.insert(flies.end(), judged.begin(), judged.end());
    }
    const auto judged = filter.last();
    flies.insert(flies.end(), judged.begin(), judged.end());
    return static_cast<int>(std::count(flies.begin(), flies.end(), 1));
  }
};

TEST_CASE("a pixel between two depths is dropped, the edge beside it is not") {
  Canvas canvas;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < 12; ++c) canvas.at(r, c) = 650.0F;
    canvas.at(r, 12) = 671.0F;
  }
  CHECK(canvas.filter() == kRows);
  for (int r = 0; r < kRows; ++r) {
    CHECK(canvas.kept(r, 11));
    CHECK_FALSE(canvas.kept(r, 12));
    CHECK(canvas.kept(r, 13));
  }
}

TEST_CASE("thin parts and steep slopes are kept") {
  Canvas canvas;
  for (int r = 0; r < kRows; ++r) {
    canvas.at(r, 6) = 690.0F;  // a blade one pixel wide
    for (int c = 15; c < kCols; ++c) canvas.at(r, c) = 700.0F - 0.6F * static_cast<float>(c - 15);  // 63 degrees
  }
  CHECK(canvas.filter() == 2);  // the blade's ends at the border of the image, which have one neighbour each
  for (int r = 1; r < kRows - 1; ++r) CHECK(canvas.kept(r, 6));
}

TEST_CASE("a lone outlier is dropped") {
  Canvas canvas;
  canvas.at(10, 10) = 640.0F;
  CHECK(canvas.filter() == 1);
  CHECK_FALSE(canvas.kept(10, 10));
}

TEST_CASE("the last pixel of a surface that is less than half covered is dropped") {
  Canvas canvas;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 20; c < kCols; ++c) canvas.at(r, c) = 0.0F;  // shadow
    canvas.modulation[static_cast<std::size_t>(r * kCols + 19)] = 25.0F;
  }
  canvas.filter();
  CHECK(canvas.kept(12, 18));
  CHECK_FALSE(canvas.kept(12, 19));
}

}  // namespace
}  // namespace beltpick::testing
