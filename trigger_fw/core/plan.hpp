// Plan: an armed sequence, and the judgement whether it can be armed at all.
#pragma once

#include "protocol/messages.hpp"

namespace beltpick {
namespace core {

// Why a sequence cannot be run as PROTOCOL.md demands; kNone when it can.
protocol::Refusal judge(const protocol::Arm& arm);

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
