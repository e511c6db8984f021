// Which of the objects in a scan are the part to be taught.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "segment/segmenter.hpp"

namespace beltpick::scans {

// The part's pixels: those of some labels inside a box.
struct CutOut {
  std::vector<std::uint16_t> labels;
  int row_min = 0, row_max = -1, col_min = 0, col_max = -1;  // inclusive
  int pixels = 0;
  bool touches_border = false;
  int left_aside = 0;  // smaller objects that are not the part

  [[nodiscard]] bool holds(std::uint16_t label) const;
};

// The largest object with its pieces: what shadows, steep sides or the part itself cut off it in the image. A piece
// lies no more than some 20 mm away over pixels that do not show the belt. Smaller objects elsewhere are left aside.
// `name` is the scan's. Errors: kNothingFound; kUsage where another object is large enough to be a part of its own.
Result<CutOut> cut_out_part(const RangeImage& range, const segment::Segmented& objects, const std::string& name);

}  // namespace beltpick::scans
