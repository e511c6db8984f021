#include "segment/fragments.hpp"

#include <algorithm>

namespace beltpick::segment {

namespace {

constexpr int kReach_px = 4;        // unmeasured pixels that an outline may reach across
constexpr double kEnclosed = 0.75;  // of the measured outline
constexpr double kSmaller = 0.3;    // of the other's pixels
constexpr int kLeastOutline_px = 12;
constexpr std::size_t kNumbers = 65536;

}  // namespace

Fragments::Fragments(Arena& arena)
    : borders_(arena),
      joined_(arena),
      outline_px_(arena.take<std::int32_t>("segment: borders", kNumbers)),
      pixels_(arena.take<std::int32_t>("segment: borders", kNumbers)) {}

void Fragments::note(const RangeImage& range, const Components& components, std::size_t here, std::size_t there) {
  const std::uint16_t a = components.label(here);
  const std::uint16_t b = components.label(there);
  if (a == b) return;
  if (a != 0 && range.point_mm.data[there].z() > 0.0F) ++outline_px_[a];
  if (b != 0 && range.point_mm.data[here].z() > 0.0F) ++outline_px_[b];
  if (a == 0 || b == 0) return;
  if (Border* border = borders_.of(a, b)) ++border->pixels;
}

// Every pair of measured pixels of different numbers that follow each other in a row or column.
void Fragments::walk(const RangeImage& range, const Components& components) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  const auto follow = [&](std::size_t here, std::size_t step, int room) {
    for (int k = 1; k <= std::min(kReach_px, room); ++k) {
      const std::size_t there = here + static_cast<std::size_t>(k) * step;
      if (range.point_mm.data[there].z() <= 0.0F) continue;
      note(range, components, here, there);
      return;
    }
  };
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const std::size_t here =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
      if (range.point_mm.data[here].z() <= 0.0F) continue;
      follow(here, 1, cols - 1 - col);
      follow(here, static_cast<std::size_t>(cols), rows - 1 - row);
    }
  }
}

void Fragments::join(const RangeImage& range, Components& components) {
  const auto labels = components.labels().first(range.point_mm.size());
  borders_.clear();
  joined_.clear();
  std::fill(outline_px_.begin(), outline_px_.end(), 0);
  std::fill(pixels_.begin(), pixels_.end(), 0);
  for (const std::uint16_t label : labels) ++pixels_[label];
  walk(range, components);
  for (const auto& entry : borders_.entries()) {
    if (entry.a == 0) continue;
    const bool a_is_piece = pixels_[entry.a] < pixels_[entry.b];
    const std::uint16_t piece = a_is_piece ? entry.a : entry.b;
    const std::uint16_t host = a_is_piece ? entry.b : entry.a;
    const bool enclosed =
        outline_px_[piece] >= kLeastOutline_px && entry.count.pixels >= kEnclosed * outline_px_[piece];
    if (enclosed && pixels_[piece] <= kSmaller * pixels_[host]) joined_.unite(piece, host);
  }
  for (std::uint16_t& label : labels) label = joined_.root(label);
}

}  // namespace beltpick::segment
