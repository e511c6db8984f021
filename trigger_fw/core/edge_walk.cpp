#include "core/edge_walk.hpp"

namespace beltpick {
namespace core {

void EdgeWalk::start(uint32_t at_ticks) {
  cursor_.restart();
  edge_ = Edge::kFrameBegins;
  first_ = true;
  at_ticks_ = at_ticks;
}

void EdgeWalk::pass(const protocol::Arm& plan) {
  switch (edge_) {
    case Edge::kFrameBegins:
      if (!first_) cursor_.advance(plan);
      first_ = false;
      frame_start_ticks_ = at_ticks_;
      at_ticks_ += ticks_of(protocol::kAdvancePulse_us);
      edge_ = Edge::kAdvanceFalls;
      return;
    case Edge::kAdvanceFalls:
      at_ticks_ = frame_start_ticks_ + ticks_of(timing(plan).settle_us);
      edge_ = Edge::kPulseRises;
      return;
    case Edge::kPulseRises:
      at_ticks_ += ticks_of(timing(plan).exposure_us);
      edge_ = Edge::kPulseFalls;
      return;
    case Edge::kPulseFalls: {
      at_ticks_ = frame_start_ticks_ + ticks_of(timing(plan).period_us);
      FrameCursor next = cursor_;
      edge_ = next.advance(plan) ? Edge::kFrameBegins : Edge::kSequenceEnds;
      return;
    }
    case Edge::kSequenceEnds:
      return;
  }
}

}  // namespace core
}  // namespace beltpick
