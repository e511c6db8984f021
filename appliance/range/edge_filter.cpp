#include "range/edge_filter.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::range {
namespace {

// A surface seen at 75 degrees from its normal climbs this many footprints a pixel; a steeper one is hardly measured.
constexpr float kSteepest = 3.73F;
constexpr float kNoiseSigmas = 5.0F;

}  // namespace

EdgeFilter::EdgeFilter(Arena& arena, int cols) {
  const auto width = static_cast<std::size_t>(cols) + 2;
  for (auto& row : depth_mm_) row = arena.take<float>("range scratch", width);
  for (auto& row : step_mm_) row = arena.take<float>("range scratch", width);
}

void EdgeFilter::load_row(const RangeImage& range, int row, float focal_px) {
  const std::span<float> depth = depth_mm_[static_cast<std::size_t>(row + 3) % 3];
  const std::span<float> step = step_mm_[static_cast<std::size_t>(row + 3) % 3];
  std::fill(depth.begin(), depth.end(), 0.0F);
  if (row < 0 || row >= range.point_mm.rows) return;
  for (int c = 0; c < range.point_mm.cols; ++c) {
    const float z = range.point_mm(row, c).z();
    const auto at = static_cast<std::size_t>(c) + 1;
    depth[at] = z;
    step[at] = std::max(kSteepest * z / focal_px, kNoiseSigmas * range.sigma_mm(row, c));
  }
}

int EdgeFilter::filter_row(const RangeImage& range, int row) {
  const float* above = depth_mm_[static_cast<std::size_t>(row + 2) % 3].data();
  const float* here = depth_mm_[static_cast<std::size_t>(row + 3) % 3].data();
  const float* below = depth_mm_[static_cast<std::size_t>(row + 4) % 3].data();
  const float* step = step_mm_[static_cast<std::size_t>(row + 3) % 3].data();
  int dropped = 0;
  for (int c = 0; c < range.point_mm.cols; ++c) {
    const int i = c + 1;
    const float z = here[i];
    if (z == 0.0F) continue;
    // Opposite neighbours: across, down, and the two diagonals, whose neighbours lie sqrt(2) away.
    const std::array<std::array<float, 2>, 4> lines = {
        {{here[i - 1], here[i + 1]}, {above[i], below[i]}, {above[i - 1], below[i + 1]}, {above[i + 1], below[i - 1]}}};
    bool between = false;
    int support = 0;
    for (std::size_t line = 0; line < lines.size(); ++line) {
      const float most = line < 2 ? step[i] : 1.4142F * step[i];
      const float first = lines[line][0] == 0.0F ? INFINITY : lines[line][0] - z;
      const float second = lines[line][1] == 0.0F ? INFINITY : lines[line][1] - z;
      support += (std::fabs(first) <= most ? 1 : 0) + (std::fabs(second) <= most ? 1 : 0);
      if (lines[line][0] == 0.0F || lines[line][1] == 0.0F) continue;
      between = between || (first > most && second < -most) || (first < -most && second > most);
    }
    if (!between && support >= 2) continue;
    range.point_mm(row, c).setZero();
    range.sigma_mm(row, c) = 0.0F;
    ++dropped;
  }
  return dropped;
}

int EdgeFilter::apply(const RangeImage& range, float focal_px) {
  int dropped = 0;
  load_row(range, -1, focal_px);
  load_row(range, 0, focal_px);
  for (int row = 0; row < range.point_mm.rows; ++row) {
    load_row(range, row + 1, focal_px);
    dropped += filter_row(range, row);
  }
  return dropped;
}

}  // namespace beltpick::range
