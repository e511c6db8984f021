#include "core/edge_walk.hpp"

namespace beltpick {
namespace core {

void EdgeWalk::start(uint32_t at_us) {
  cursor_.restart();
  edge_ = Edge::kFrameBegins;
  first_ = true;
  at_us_ = at_us;
}

void EdgeWalk::pass(const protocol::Arm& plan) {
  switch (edge_) {
    case Edge::kFrameBegins:
      if (!first_) cursor_.advance(plan);
      first_ = false;
      frame_start_us_ = at_us_;
      at_us_ += protocol::kAdvancePulse_us;
      edge_ = Edge::kAdvanceFalls;
      return;
    case Edge::kAdvanceFalls:
      at_us_ = frame_start_us_ + timing(plan).settle_us;
      edge_ = Edge::kPulseRises;
      return;
    case Edge::kPulseRises:
      at_us_ += timing(plan).exposure_us;
      edge_ = Edge::kPulseFalls;
      return;
    case Edge::kPulseFalls: {
      at_us_ = frame_start_us_ + timing(plan).period_us;
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
