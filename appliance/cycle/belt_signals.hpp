// Judges the two belt-stopped signals, the hard-wired line and the PLC's register: they must agree, or come to agree
// within a time; and times how long the cell has been at rest before a capture may start.
#pragma once

#include <cstdint>

namespace beltpick::cycle {

struct RestTimes {
  std::int64_t settle_us = 0;         // at rest for so long before a capture
  std::int64_t signals_agree_us = 0;  // line and register may differ for so long
};

class BeltSignals {
 public:
  explicit BeltSignals(const RestTimes& times) : times_(times) {}

  // Forgets the past: settling starts anew.
  void restart(std::int64_t now_us);

  // Takes the signals of this moment. Line and register of different opinion start the time they may differ for; at
  // rest means that both say stopped and the robot is clear.
  void sample(std::int64_t now_us, bool line_stopped, bool register_stopped, bool robot_clear);

  [[nodiscard]] bool held() const { return line_ && register_; }      // both say: stopped
  [[nodiscard]] bool moving() const { return !line_ && !register_; }  // both say: moves
  [[nodiscard]] bool disagree_too_long() const { return disagree_us_ > times_.signals_agree_us; }
  [[nodiscard]] bool settled() const { return at_rest_ && rest_us_ >= times_.settle_us; }

 private:
  RestTimes times_;
  bool line_ = false;
  bool register_ = false;
  bool at_rest_ = false;
  bool differ_ = false;
  std::int64_t rest_since_us_ = 0;
  std::int64_t differ_since_us_ = 0;
  std::int64_t rest_us_ = 0;
  std::int64_t disagree_us_ = 0;
};

}  // namespace beltpick::cycle
