#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"
#include "decode/plan_parts.hpp"

namespace beltpick::decode {
namespace {

constexpr int kMaxBits = 16;

// The Gray frames of one stripe width.
struct Stripes {
  double width_px = 0.0;
  GrayBit bit;
};

std::vector<Stripes> collect_stripes(const Sequence& sequence, const ExposureRanks& ranks, int exposure, Axis axis) {
  std::vector<Stripes> all;
  for (int i = 0; i < static_cast<int>(sequence.frames.size()); ++i) {
    const FrameSpec& frame = sequence.frames[static_cast<std::size_t>(i)];
    if (frame.kind != FrameKind::kGray || frame.axis != axis || !ranks.belongs(i, exposure)) continue;
    const double width_px = std::ldexp(frame.cell_px, frame.bit);
    auto stripes = std::find_if(all.begin(), all.end(),
                                [&](const Stripes& s) { return std::abs(s.width_px - width_px) < 1e-6 * width_px; });
    if (stripes == all.end()) stripes = all.insert(all.end(), Stripes{width_px, {}});
    (frame.inverted ? stripes->bit.twin_frame : stripes->bit.frame) = i;
  }
  std::sort(all.begin(), all.end(), [](const Stripes& a, const Stripes& b) { return a.width_px < b.width_px; });
  return all;
}

// The chain that starts at `first`; `missing_px` is the width it lacks, 0 where it is whole.
GrayCode chain_from(const std::vector<Stripes>& all, std::size_t first, double extent_px, double& missing_px) {
  GrayCode code;
  code.cell_px = all[first].width_px;
  code.cells = static_cast<int>(std::ceil(extent_px / code.cell_px - 1e-6));
  missing_px = 0.0;
  for (double width_px = code.cell_px; static_cast<int>(code.bits.size()) < kMaxBits; width_px *= 2.0) {
    const auto stripes = std::find_if(
        all.begin(), all.end(), [&](const Stripes& s) { return std::abs(s.width_px - width_px) < 1e-6 * width_px; });
    if (stripes == all.end()) {
      missing_px = width_px;
      break;
    }
    code.bits.push_back(stripes->bit);
    if (2.0 * width_px >= extent_px - 1e-6) break;
  }
  return code;
}

// True where `width_px` is `cell_px` times a power of two.
bool of_one_family(double cell_px, double width_px) {
  const double doublings = std::log2(width_px / cell_px);
  return std::abs(doublings - std::round(doublings)) < 1e-6;
}

}  // namespace

Result<GrayCode> chain_gray(const Sequence& sequence, const ExposureRanks& ranks, int exposure, Axis axis) {
  const std::vector<Stripes> all = collect_stripes(sequence, ranks, exposure, axis);
  const double extent_px = sequence.projector.extent(axis);
  double first_missing_px = 0.0;
  std::vector<double> families;
  for (std::size_t first = 0; first < all.size(); ++first) {
    const double cell_px = all[first].width_px;
    if (std::any_of(families.begin(), families.end(), [&](double f) { return of_one_family(f, cell_px); })) continue;
    families.push_back(cell_px);
    double missing_px = 0.0;
    GrayCode code = chain_from(all, first, extent_px, missing_px);
    if (missing_px == 0.0) return code;
    if (first_missing_px == 0.0) first_missing_px = missing_px;
  }
  if (all.empty()) return GrayCode{};
  return failure(
      ResultCode::kSequenceUndecodable,
      "%s axis: the Gray frame with stripes of %g px (cell_px %g, bit %d) is missing; a Gray code from %g px "
      "over %g px needs every doubling",
      axis_name(axis), first_missing_px, all.front().width_px,
      static_cast<int>(std::lround(std::log2(first_missing_px / all.front().width_px))), all.front().width_px,
      extent_px);
}

}  // namespace beltpick::decode
