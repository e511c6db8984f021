// Whether the two frames of every Gray bit are each other's inverse.
#include "contract/result_codes.hpp"
#include "decode/frame_check.hpp"

namespace beltpick::decode {
namespace {

// Share of the lit probes at which both frames are bright beyond doubt, or both dark: never, where they are twins.
float alike_share(const ProbeLevels& levels, const GrayBit& bit) {
  constexpr float kBeyondDoubt = 0.25F;  // of the contrast, from the middle
  const Witnesses& witnesses = *levels.witnesses;
  const float* low8 = witnesses.low8();
  const float* high8 = witnesses.high8();
  return lit_share(levels,
                   [=, upright8 = witnesses.level8(bit.frame), inverted8 = witnesses.level8(bit.twin_frame)](int w) {
                     const float middle = 0.5F * (high8[w] + low8[w]);
                     const float upright = upright8[w] - middle;
                     const float inverted = inverted8[w] - middle;
                     const float sure = kBeyondDoubt * (high8[w] - low8[w]);
                     return ((upright > sure) & (inverted > sure)) | ((upright < -sure) & (inverted < -sure));
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
