// Segmenter: cuts an ordered range image into objects at depth discontinuities (the paper's section 3.1).
#pragma once

#include <optional>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"
#include "contract/limits.hpp"
#include "segment/cavities.hpp"
#include "segment/components.hpp"
#include "segment/creases.hpp"
#include "segment/fragments.hpp"
#include "segment/roster.hpp"
#include "segment/scale.hpp"
#include "segment/support_plane.hpp"

namespace beltpick::segment {

struct SegmentOptions {
  std::optional<Plane> belt{};  // where it is known; else it is found in the image
  // Cuts objects that touch apart where they meet in a sharp concave edge. A part with such an edge of its own is cut
  // too: who knows the parts leaves it off and takes found parts away from what is joined.
  // Needs a segmenter made with CreaseCut::kAvailable.
  bool cut_creases = false;
  // Joins small pieces that another object encloses to it. Who knows the parts leaves this off too.
  bool join_fragments = false;
};

// Whether a segmenter takes the memory that cutting at creases needs (about 40 bytes a pixel).
enum class CreaseCut : std::uint8_t { kLeftOut, kAvailable };

// Views of the segmenter's memory, valid until its next segment().
struct Segmented {
  ImageView<const std::uint16_t> labels;  // 0: belt, table or nothing
  std::span<const Segment> segments;      // label i + 1 at position i, top left first
  std::optional<Plane> belt;              // nothing where no plane carries the view
  int left_out = 0;                       // objects beyond the declared limit, the smallest: kSegmentLimit
};

class Segmenter {
 public:
  // Images up to limits.image_width x image_height, objects up to limits.segments.
  Segmenter(Arena& arena, const Limits& limits, CreaseCut creases = CreaseCut::kLeftOut);

  // Any ordered cloud in mm: threshold d follows the image's own pixel spacing and noise. Allocates nothing.
  Segmented segment(const RangeImage& range, const SegmentOptions& options = {});

 private:
  void mark_objects(const RangeImage& range, const Scale& scale, const std::optional<SupportPlane>& support);
  void open_mask(int rows, int cols);
  void return_poor_pixels(const RangeImage& range, const Scale& scale);

  SupportPlaneFinder plane_finder_;
  Components components_;
  Cavities cavities_;
  Fragments fragments_;
  Roster roster_;
  std::optional<Creases> creases_;
  std::span<std::uint8_t> mask_, opened_;
  std::span<float> height_mm_;
  std::span<std::uint16_t> labels_;
};

}  // namespace beltpick::segment
