// Cuts objects that touch apart along the sharp concave edge between them.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "segment/components.hpp"
#include "segment/pair_table.hpp"
#include "segment/scale.hpp"

namespace beltpick::segment {

// Solid bodies that touch meet in a sharp concave edge; a fillet within a casting turns more slowly than the few pixels
// looked at here. A cut is made only where both pieces are a good share of the whole and their border is concave for
// most of its length.
class Creases {
 public:
  Creases(Arena& arena, int max_pixels);

  // Gives the pieces of cut components numbers of their own from count + 1 on; returns the highest number. `mask` is
  // left as the pixels without creases.
  int cut(const RangeImage& range, const Scale& scale, Components& components, int count, std::span<std::uint8_t> mask,
          int min_pixels);

 private:
  struct Border {
    int pixels = 0;
    int concave = 0;
  };

  void smooth(const RangeImage& range, const Components& components);
  void find_normals(int rows, int cols);
  void find_concave(const RangeImage& range, const Scale& scale, const Components& components);
  void clear_near_steps(const RangeImage& range, const Scale& scale, const Components& components);
  void keep_large_pieces(int pieces, int min_pixels);
  void grow_pieces(int rows, int cols);
  void join_pieces(int rows, int cols);
  int renumber(Components& components, int count, std::size_t pixels, int pieces);

  Components pieces_;
  PairTable<Border> borders_;
  LabelUnion joined_;
  std::span<Vec3f> smooth_mm_, normal_;
  std::span<std::uint8_t> concave_;  // nonzero: on a crease
  std::span<std::uint16_t> whole_;   // the component's number before the cut
  std::span<std::int32_t> queue_;
  std::span<std::int32_t> piece_size_, piece_whole_, whole_size_;
};

}  // namespace beltpick::segment
