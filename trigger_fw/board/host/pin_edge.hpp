// PinEdge: an edge of one of the trigger board's outputs, as the world around the board sees it.
#pragma once

#include <cstdint>

namespace beltpick::host {

enum class Pin : std::uint8_t { kBusy, kProjectorAdvance, kCameraTrigger, kDone, kFault };

struct PinEdge {
  Pin pin = Pin::kBusy;
  bool level = false;
  std::uint32_t board_us = 0;  // the board's clock: differences are exactly as armed; wraps
  std::int64_t at_ns = 0;      // CLOCK_MONOTONIC when it happened
};

}  // namespace beltpick::host
