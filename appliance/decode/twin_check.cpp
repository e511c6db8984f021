// Whether the two frames of every Gray bit are each other's inverse.
#include <algorithm>

#include "contract/result_codes.hpp"
#include "decode/frame_check.hpp"

namespace beltpick::decode {
namespace {

// Share of the lit probes at which both frames are bright beyond doubt, or both dark: never, where they are twins.
float alike_share(const ProbeLevels& levels, const GrayBit& bit) {
  constexpr float kBeyondDoubt = 0.25F;  // of the contrast, from the middle
  return lit_share(levels, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    const float middle = 0.5F * (levels.high8[at] + levels.low8[at]);
    const float upright = levels.level8(bit.frame, i) - middle;
    const float inverted = levels.level8(bit.twin_frame, i) - middle;
    const float sure = kBeyondDoubt * levels.contrast8(i);
    return std::min(upright, inverted) > sure || std::max(upright, inverted) < -sure;
  });
}

}  // namespace

Result<void> check_twins(const ProbeLevels& levels, const GrayCode& code) {
  constexpr float kMostAlike = 0.08F;
  for (auto bit = code.bits.rbegin(); bit != code.bits.rend(); ++bit) {  // in the usual order of projection
    if (bit->frame == kNone || bit->twin_frame == kNone) continue;
    const float alike = alike_share(levels, *bit);
    if (alike < kMostAlike) continue;
    return failure(
        ResultCode::kSequenceOrderWrong,
        "the Gray frames %s and %s are declared each other's inverse, but are alike at %.0f %% of the places: "
        "a frame at or before them is missing, repeated or exchanged",
        levels.spec(bit->frame).file.c_str(), levels.spec(bit->twin_frame).file.c_str(),
        static_cast<double>(100.0F * alike));
  }
  return {};
}

}  // namespace beltpick::decode
