#include "segment/creases.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.hpp"

namespace beltpick::segment {

namespace {

constexpr int kSmooth_px = 3;     // half window over which points are averaged, and half base of the tangents
constexpr int kBase_px = 4;       // half distance between the normals compared
constexpr int kStepClear_px = 4;  // at a depth step the smoothed surface is bent for no reason
constexpr double kSharp_rad = rad_from_deg(40.0);
constexpr double kPieceShare = 0.12;
constexpr double kConcaveShare = 0.6;
constexpr int kConcaveReach_px = 2;
constexpr int kMaxPieces = 65536;
constexpr std::array<std::array<int, 2>, 4> kDirections{{{0, 1}, {1, 0}, {1, 1}, {1, -1}}};

}  // namespace

Creases::Creases(Arena& arena, int max_pixels)
    : pieces_(arena, max_pixels),
      borders_(arena),
      joined_(arena),
      smooth_mm_(arena.take<Vec3f>("segment: creases", static_cast<std::size_t>(max_pixels))),
      normal_(arena.take<Vec3f>("segment: creases", static_cast<std::size_t>(max_pixels))),
      concave_(arena.take<std::uint8_t>("segment: creases", static_cast<std::size_t>(max_pixels))),
      whole_(arena.take<std::uint16_t>("segment: creases", static_cast<std::size_t>(max_pixels))),
      queue_(arena.take<std::int32_t>("segment: creases", static_cast<std::size_t>(max_pixels))),
      piece_size_(arena.take<std::int32_t>("segment: creases", kMaxPieces)),
      piece_whole_(arena.take<std::int32_t>("segment: creases", kMaxPieces)),
      whole_size_(arena.take<std::int32_t>("segment: creases", kMaxPieces)) {}

void Creases::smooth(const RangeImage& range, const Components& components) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  constexpr int kLeast = (2 * kSmooth_px + 1) * (2 * kSmooth_px + 1) * 3 / 10;
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const int here = row * cols + col;
      const std::uint16_t label = components.label(static_cast<std::size_t>(here));
      whole_[here] = label;
      smooth_mm_[here].setZero();
      if (label == 0) continue;
      Vec3f sum = Vec3f::Zero();
      int count = 0;
      for (int r = std::max(0, row - kSmooth_px); r <= std::min(rows - 1, row + kSmooth_px); ++r) {
        for (int c = std::max(0, col - kSmooth_px); c <= std::min(cols - 1, col + kSmooth_px); ++c) {
          if (components.label(static_cast<std::size_t>(r * cols + c)) != label) continue;
          sum += range.point_mm(r, c);
          ++count;
        }
      }
      if (count >= kLeast) smooth_mm_[here] = sum / static_cast<float>(count);
    }
  }
}

void Creases::find_normals(int rows, int cols) {
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const int here = row * cols + col;
      normal_[here].setZero();
      if (row < kSmooth_px || col < kSmooth_px || row + kSmooth_px >= rows || col + kSmooth_px >= cols) continue;
      const std::array around{here - kSmooth_px, here + kSmooth_px, here - kSmooth_px * cols, here + kSmooth_px * cols};
      const bool whole = smooth_mm_[here].z() > 0.0F && std::all_of(around.begin(), around.end(), [&](int p) {
                           return smooth_mm_[p].z() > 0.0F && whole_[p] == whole_[here];
                         });
      if (!whole) continue;
      const Vec3f across = smooth_mm_[around[1]] - smooth_mm_[around[0]];
      const Vec3f down = smooth_mm_[around[3]] - smooth_mm_[around[2]];
      const Vec3f normal = across.cross(down).normalized();
      normal_[here] = normal.dot(smooth_mm_[here]) > 0.0F ? Vec3f(-normal) : normal;
    }
  }
}

void Creases::find_concave(const RangeImage& range, const Scale& scale, const Components& components) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  const auto sharp = static_cast<float>(std::cos(kSharp_rad));
  std::fill(concave_.begin(), concave_.end(), std::uint8_t{0});
  for (int row = kBase_px; row < rows - kBase_px; ++row) {
    for (int col = kBase_px; col < cols - kBase_px; ++col) {
      const int here = row * cols + col;
      if (whole_[here] == 0) continue;
      for (const auto& [down, right] : kDirections) {
        const int offset = kBase_px * (down * cols + right);
        const int before = here - offset;
        const int after = here + offset;
        if (whole_[before] != whole_[here] || whole_[after] != whole_[here]) continue;
        const Vec3f& n1 = normal_[before];
        const Vec3f& n2 = normal_[after];
        if (n1.isZero() || n2.isZero() || n1.dot(n2) > sharp) continue;
        if ((n2 - n1).dot(smooth_mm_[after] - smooth_mm_[before]) < 0.0F) concave_[here] = 1;
      }
    }
  }
  clear_near_steps(range, scale, components);
}

void Creases::clear_near_steps(const RangeImage& range, const Scale& scale, const Components& components) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  for (int row = 0; row + 1 < rows; ++row) {
    for (int col = 0; col + 1 < cols; ++col) {
      const int here = row * cols + col;
      if (components.label(static_cast<std::size_t>(here)) == 0) continue;
      const auto step_to = [&](int down, int right) {
        return components.label(static_cast<std::size_t>(here + down * cols + right)) != 0 &&
               !linked(range.point_mm(row, col), range.point_mm(row + down, col + right), scale);
      };
      if (!step_to(0, 1) && !step_to(1, 0)) continue;
      for (int r = std::max(0, row - kStepClear_px); r <= std::min(rows - 1, row + kStepClear_px); ++r) {
        for (int c = std::max(0, col - kStepClear_px); c <= std::min(cols - 1, col + kStepClear_px); ++c) {
          concave_[r * cols + c] = 0;
        }
      }
    }
  }
}

void Creases::keep_large_pieces(int pieces, int min_pixels) {
  for (std::int32_t piece = 1; piece <= pieces; ++piece) {
    const std::int32_t whole_px = whole_size_[piece_whole_[piece]];
    const bool large = piece_size_[piece] >= 3 * min_pixels && piece_size_[piece] >= kPieceShare * whole_px;
    if (!large) piece_size_[piece] = 0;
  }
  for (std::uint16_t& label : pieces_.labels()) {
    if (piece_size_[label] == 0) label = 0;
  }
}

void Creases::grow_pieces(int rows, int cols) {
  // Breadth first from all pieces at once: a crease's pixels go to the piece that is nearest within the component.
  std::size_t tail = 0;
  const auto labels = pieces_.labels();
  const int pixels = rows * cols;
  for (int p = 0; p < pixels; ++p) {
    if (labels[p] != 0) queue_[tail++] = p;
  }
  for (std::size_t head = 0; head < tail; ++head) {
    const int here = queue_[head];
    const int col = here % cols;
    const std::array<int, 4> next{here - cols, here + cols, col > 0 ? here - 1 : -1, col + 1 < cols ? here + 1 : -1};
    for (const int there : next) {
      if (there < 0 || there >= pixels || labels[there] != 0 || whole_[there] != whole_[here] || whole_[there] == 0)
        continue;
      labels[there] = labels[here];
      queue_[tail++] = there;
    }
  }
}

void Creases::join_pieces(int rows, int cols) {
  borders_.clear();
  const auto labels = pieces_.labels();
  const auto on_crease = [&](int row, int col) {
    for (int r = std::max(0, row - kConcaveReach_px); r <= std::min(rows - 1, row + kConcaveReach_px); ++r) {
      for (int c = std::max(0, col - kConcaveReach_px); c <= std::min(cols - 1, col + kConcaveReach_px); ++c) {
        if (concave_[r * cols + c] != 0) return true;
      }
    }
    return false;
  };
  for (int row = 0; row + 1 < rows; ++row) {
    for (int col = 0; col + 1 < cols; ++col) {
      const int here = row * cols + col;
      for (const int there : {here + 1, here + cols}) {
        if (labels[here] == 0 || labels[there] == 0 || labels[here] == labels[there] || whole_[here] != whole_[there])
          continue;
        Border* border = borders_.of(labels[here], labels[there]);
        if (border == nullptr) continue;
        ++border->pixels;
        if (on_crease(row, col)) ++border->concave;
      }
    }
  }
  joined_.clear();
  std::fill(piece_size_.begin(), piece_size_.end(), 0);
  for (const auto& entry : borders_.entries()) {
    piece_size_[entry.a] = piece_size_[entry.b] = 1;  // from here on: has a neighbour
    if (entry.a != 0 && entry.count.concave < kConcaveShare * entry.count.pixels) joined_.unite(entry.a, entry.b);
  }
}

int Creases::renumber(Components& components, int count, std::size_t pixels, int pieces) {
  // What no crease borders on stays with the rest: the two sides of a cavity's rim.
  std::fill(whole_size_.begin(), whole_size_.end(), 0);
  for (std::int32_t piece = 1; piece <= pieces; ++piece) {
    std::int32_t& first = whole_size_[piece_whole_[piece]];
    if (first == 0) first = piece;
    if (piece_size_[piece] == 0) joined_.unite(static_cast<std::uint16_t>(piece), static_cast<std::uint16_t>(first));
  }
  // The first piece of a component keeps its number.
  auto& number = piece_size_;
  std::fill(number.begin(), number.end(), 0);
  std::fill(whole_size_.begin(), whole_size_.end(), 0);
  int highest = count;
  for (std::int32_t piece = 1; piece <= pieces; ++piece) {
    if (joined_.root(static_cast<std::uint16_t>(piece)) != piece) continue;
    std::int32_t& taken = whole_size_[piece_whole_[piece]];
    number[piece] = taken == 0 ? piece_whole_[piece] : ++highest;
    taken = 1;
  }
  const auto labels = components.labels();
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::uint16_t piece = pieces_.label(p);
    if (piece != 0) labels[p] = static_cast<std::uint16_t>(number[joined_.root(piece)]);
  }
  return highest;
}

int Creases::cut(const RangeImage& range, const Scale& scale, Components& components, int count,
                 std::span<std::uint8_t> mask, int min_pixels) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  const std::size_t pixels = range.point_mm.size();
  smooth(range, components);
  find_normals(rows, cols);
  find_concave(range, scale, components);
  std::fill(whole_size_.begin(), whole_size_.end(), 0);
  for (std::size_t p = 0; p < pixels; ++p) {
    ++whole_size_[whole_[p]];
    // Where no normal is known, along the outline, a crease cannot be seen: it must not be a bridge.
    mask[p] = whole_[p] != 0 && concave_[p] == 0 && !normal_[p].isZero() ? 1 : 0;
  }
  const int pieces = pieces_.find(range, mask, scale, min_pixels);
  std::fill(piece_size_.begin(), piece_size_.end(), 0);
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::uint16_t piece = pieces_.label(p);
    if (piece == 0) continue;
    ++piece_size_[piece];
    piece_whole_[piece] = whole_[p];
  }
  keep_large_pieces(pieces, min_pixels);
  grow_pieces(rows, cols);
  join_pieces(rows, cols);
  return renumber(components, count, pixels, pieces);
}

}  // namespace beltpick::segment
