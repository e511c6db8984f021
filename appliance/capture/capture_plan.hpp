// CapturePlan: what a recipe's sequence means for trigger and camera: the timing to arm, and what each frame must look
// like. Made when a recipe is loaded, not per cycle.
#pragma once

#include <span>
#include <vector>

#include "base/result.hpp"
#include "contract/capture.hpp"
#include "protocol/messages.hpp"

namespace beltpick::capture {

struct CaptureTiming {
  double exposure_us = 8000;         // of frames whose spec gives none
  std::uint32_t settle_us = 1000;    // projector advance to exposure
  std::uint32_t readout_us = 12000;  // camera: what it needs after the end of an exposure to read it out
  // 0: the camera is triggered when it has read out. Else it exposes meanwhile, with this pause between two exposures.
  std::uint16_t overlap_gap_us = 0;
  std::uint32_t period_us = 0;  // 0: the shortest that the others allow
  std::uint32_t strobe_tolerance_us = 500;
  std::uint16_t host_silence_ms = 500;
  // What the projector needs besides, of every frame: it may be longer than the period. Empty: nothing.
  std::span<const std::uint32_t> least_period_us = {};
};

// What the checks may expect of one frame.
struct FrameExpectation {
  bool dark = false;     // projected black
  bool bright = false;   // projected white
  bool stripes = false;  // narrow enough that any view holds bright and dark ones
  bool phase = false;
  bool repeats = false;  // the pattern of the frame before once more (an HDR repeat): not a duplicate
  double exposure_us = 0.0;
};

struct CapturePlan {
  protocol::Arm timing;  // without its id
  std::vector<FrameExpectation> frames;
  std::int64_t duration_us = 0;  // START to DONE
  unsigned number = 0;  // another one for every plan made: what was learnt under one does not hold for the next
};

// kLimitExceeded: more frames or more changes of exposure than the firmware holds. kValueOutOfRange: a timing that
// cannot be run.
Result<CapturePlan> make_plan(const Sequence& sequence, const CaptureTiming& timing);

}  // namespace beltpick::capture
