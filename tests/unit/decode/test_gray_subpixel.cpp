// Positions within Gray cells against a version that goes from run to run.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <random>
#include <vector>

#include "decode/gray_subpixel.hpp"

namespace beltpick::decode {
namespace {

struct Row {
  std::vector<std::uint16_t> cell;
  std::vector<PixelState> state;
  std::vector<float> x_px;

  [[nodiscard]] int count() const { return static_cast<int>(cell.size()); }
};

// The pixels from first to before end have one cell; none where first == end.
struct Run {
  int first = 0, end = 0;
  int cell = 0;

  [[nodiscard]] int length() const { return end - first; }
};

Run run_from(const Row& row, int first) {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  Run run{first, first, first < row.count() ? row.cell[at(first)] : 0};
  while (run.end < row.count() && row.state[at(run.end)] == PixelState::kValid && row.cell[at(run.end)] == run.cell) {
    ++run.end;
  }
  return run;
}

bool goes_on(const Run& run, const Run& next) {
  const int shorter = std::min(run.length(), next.length());
  const int longer = std::max(run.length(), next.length());
  return shorter > 0 && next.first == run.end && std::abs(next.cell - run.cell) == 1 && longer <= 3 * shorter + 2;
}

std::vector<float> plain(const Row& row, float cell_px) {
  std::vector<float> x_px = row.x_px;
  const auto border_px = [&](const Run& a, const Run& b) {
    return static_cast<float>(std::max(a.cell, b.cell)) * cell_px - 0.5F;
  };
  Run before;
  for (Run run = run_from(row, 0); run.first < row.count();) {
    const Run next = run_from(row, run.length() > 0 ? run.end : run.first + 1);
    if (goes_on(before, run) && goes_on(run, next) && before.cell != next.cell) {
      const float left_px = border_px(before, run);
      const float per_pixel = (border_px(run, next) - left_px) / static_cast<float>(run.length());
      for (int i = run.first; i < run.end; ++i) {
        x_px[static_cast<std::size_t>(i)] = left_px + (static_cast<float>(i - run.first) + 0.5F) * per_pixel;
      }
    }
    before = run;
    run = next;
  }
  return x_px;
}

// A row over surfaces that rise, fall or jump, in runs of about `length` pixels, some pixels of which are not valid.
Row make_row(int count, int length, std::mt19937& random) {
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  Row row;
  int cell = below(2000);
  int direction = 1;
  while (row.count() < count) {
    const int run = std::max(1, length / 2 + below(length + 1));
    const bool broken = below(12) == 0;
    for (int i = 0; i < run && row.count() < count; ++i) {
      row.cell.push_back(static_cast<std::uint16_t>(cell));
      row.state.push_back(broken || below(60 * length) == 0 ? PixelState::kDark : PixelState::kValid);
      row.x_px.push_back(-1.0F - static_cast<float>(row.x_px.size()));
    }
    if (below(10) == 0) direction = -direction;
    cell = below(15) == 0 ? below(65536) : (cell + direction) & 0xFFFF;
  }
  return row;
}

std::vector<float> refined(const Row& row, float cell_px) {
  std::vector<float> x_px = row.x_px;
  std::vector<std::uint16_t> scratch(run_scratch_numbers(row.count()));
  refine_cells_row(row.cell.data(), row.state.data(), row.count(), {.cell_px = cell_px}, scratch, x_px.data());
  return x_px;
}

TEST_CASE("positions within Gray cells are those that runs of pixels give, whatever their lengths") {
  std::mt19937 random(20260503);
  int moved = 0;
  for (const int count : {1, 2, 3, 7, 31, 64, 200, 1280, 3001}) {
    for (const int length : {1, 2, 3, 9, 40, 130, 300, 700}) {
      for (int repeat = 0; repeat < 8; ++repeat) {
        const Row row = make_row(count, length, random);
        const std::vector<float> expected = plain(row, 1.7F);
        moved += expected != row.x_px ? 1 : 0;
        INFO(count << " pixels in runs of about " << length);
        REQUIRE(refined(row, 1.7F) == expected);
      }
    }
  }
  CHECK(moved > 200);
}

TEST_CASE("one cell all over the row, and cells at the ends of their range, keep their centres") {
  Row row;
  row.cell.assign(1500, 7);
  row.state.assign(1500, PixelState::kValid);
  row.x_px.assign(1500, 3.0F);
  CHECK(refined(row, 4.0F) == row.x_px);
  for (std::size_t i = 0; i < row.cell.size(); ++i) row.cell[i] = i % 8 < 4 ? 0xFFFF : 0;  // no neighbours
  CHECK(refined(row, 4.0F) == row.x_px);
}

}  // namespace
}  // namespace beltpick::decode
