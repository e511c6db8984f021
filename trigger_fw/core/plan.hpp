// Plan: an armed sequence, and the judgement whether it can be armed at all.
#pragma once

#include "protocol/messages.hpp"

namespace beltpick {
namespace core {

// The unit of the core's clock, and of what it measures.
constexpr uint16_t kTick_ns = 500;
constexpr uint32_t ticks_of(uint32_t us) { return us << 1U; }

// What the board beneath the core can do. The defaults are those of a board that serves each edge when it is due.
struct BoardTiming {
  uint16_t start_lead_us = 0;    // START to the first edge: time to prepare the timer
  uint16_t late_limit_us = 200;  // an edge served later than this spoils the exposure or the pattern
  uint16_t min_interval_us = 1;  // from one edge of a pin to its next: below it the interrupt between them comes late
  uint16_t min_exposure_us = 1;  // the shortest camera pulse
  uint16_t min_period_us = 0;    // the shortest period, whatever it holds
};

// Why a sequence cannot be run as PROTOCOL.md demands; kNone when it can.
protocol::Refusal judge(const protocol::Arm& arm, const BoardTiming& board = BoardTiming());

bool same_sequence(const protocol::Arm& a, const protocol::Arm& b);

uint16_t total_frames(const protocol::Arm& arm);

// Walks the frames of an armed sequence group by group.
class FrameCursor {
 public:
  void restart() { *this = FrameCursor(); }
  // False behind the last frame.
  bool advance(const protocol::Arm& arm);

  const protocol::Group& timing(const protocol::Arm& arm) const { return arm.groups[group_]; }
  uint16_t frame() const { return frame_; }

 private:
  uint8_t group_ = 0;
  uint16_t in_group_ = 0;
  uint16_t frame_ = 0;
};

}  // namespace core
}  // namespace beltpick
