#include "contract/exposures.hpp"

#include <algorithm>
#include <cstdio>

#include "contract/result_codes.hpp"

namespace beltpick {

Result<Sequence> at_exposures(const Sequence& sequence, std::span<const double> exposures_us) {
  const bool told = std::any_of(sequence.frames.begin(), sequence.frames.end(),
                                [](const FrameSpec& frame) { return frame.exposure_us > 0.0; });
  if (told) {
    return failure(ResultCode::kUsage,
                   "exposures_us: the sequence tells its frames' exposure_us itself; leave out one");
  }
  Sequence repeated{sequence.projector, {}, {}};
  for (const double exposure_us : exposures_us) {
    if (std::count(exposures_us.begin(), exposures_us.end(), exposure_us) > 1) {
      return failure(ResultCode::kUsage, "exposures_us: expected different exposures, found %g us twice", exposure_us);
    }
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      FrameSpec& frame = repeated.frames.emplace_back(sequence.frames[i]);
      frame.exposure_us = exposure_us;
      char name[32];
      std::snprintf(name, sizeof name, "%03zu.png", repeated.frames.size() - 1);
      frame.file = name;
      if (!sequence.flash.empty()) repeated.flash.push_back(sequence.flash[i]);
    }
  }
  return repeated;
}

}  // namespace beltpick
