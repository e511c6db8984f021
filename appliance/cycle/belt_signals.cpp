#include "cycle/belt_signals.hpp"

namespace beltpick::cycle {

void BeltSignals::restart(std::int64_t now_us) {
  at_rest_ = differ_ = false;
  rest_since_us_ = differ_since_us_ = now_us;
  rest_us_ = disagree_us_ = 0;
}

void BeltSignals::sample(std::int64_t now_us, bool line_stopped, bool register_stopped, bool robot_clear) {
  line_ = line_stopped;
  register_ = register_stopped;

  const bool at_rest = held() && robot_clear;
  if (at_rest && !at_rest_) rest_since_us_ = now_us;
  at_rest_ = at_rest;
  rest_us_ = at_rest ? now_us - rest_since_us_ : 0;

  const bool differ = line_ != register_;
  if (differ && !differ_) differ_since_us_ = now_us;
  differ_ = differ;
  disagree_us_ = differ ? now_us - differ_since_us_ : 0;
}

}  // namespace beltpick::cycle
