// EdgeWalk: the output edges of an armed sequence one by one, each with its time. The sequencer walks it as time
// passes; a board whose timer drives the pins walks its own some edges ahead.
#pragma once

#include "core/plan.hpp"

namespace beltpick {
namespace core {

enum class Edge : uint8_t {
  kFrameBegins,   // projector advance rises
  kAdvanceFalls,  // projector advance falls
  kPulseRises,    // camera trigger rises
  kPulseFalls,    // camera trigger falls
  kSequenceEnds,  // no pin moves: the last frame's period is over
};

class EdgeWalk {
 public:
  // The first frame begins at `at_ticks`.
  void start(uint32_t at_ticks);

  // The next edge and its time.
  Edge edge() const { return edge_; }
  uint32_t at_ticks() const { return at_ticks_; }

  // Goes on to the edge behind it; stays at kSequenceEnds.
  void pass(const protocol::Arm& plan);

  // The frame under way: that of the edge passed last.
  uint16_t frame() const { return cursor_.frame(); }
  const protocol::Group& timing(const protocol::Arm& plan) const { return cursor_.timing(plan); }

 private:
  FrameCursor cursor_;
  Edge edge_ = Edge::kSequenceEnds;
  bool first_ = true;
  uint32_t frame_start_ticks_ = 0;
  uint32_t at_ticks_ = 0;
};

}  // namespace core
}  // namespace beltpick
