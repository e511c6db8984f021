// Cycle: the cell's state machine. One call of step() looks at the signals, timers, reports and the PLC's command of
// this moment, walks the transition table and answers with the actions for the hardware. It owns no thread, reads no
// clock and allocates nothing, so a test can drive it through a day in a millisecond.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contract/locate_result.hpp"
#include "contract/registers.hpp"
#include "contract/result_codes.hpp"
#include "cycle/belt_signals.hpp"
#include "cycle/pick_plan.hpp"
#include "cycle/transition_table.hpp"

namespace beltpick::cycle {

struct CycleConfig {
  RestTimes rest{.settle_us = 200'000, .signals_agree_us = 500'000};
  std::int64_t capture_timeout_us = 3'000'000;  // beyond what the sequence takes
  std::int64_t processing_timeout_us = 20'000'000;
  std::int64_t max_age_us = 15'000'000;    // of an offer, from the moment it was made
  int max_failed_picks = 3;                // in a row within one cycle; then a person must look
  std::uint16_t first_offer_sequence = 1;  // not one used before a restart: an old answer must not fit a new offer
};

// How a capture or the locating of one ended; `capture` is the number that the action gave, so that the report of one
// that was aborted is known to be stale. `ended` false: nothing to report.
struct CaptureOutcome {
  bool ended = false;
  std::uint16_t capture = 0;
  ResultCode code = ResultCode::kOk;
};
struct LocateOutcome {
  bool ended = false;
  std::uint16_t capture = 0;
  ResultCode code = ResultCode::kOk;
  std::span<const LocatedPart> parts;  // in pick order; must stay until the next capture starts
  int withheld = 0;
  ResultCode withheld_code = ResultCode::kOk;  // of the first of them
};

struct CycleInputs {
  std::int64_t now_us = 0;
  bool emergency_stop = false;
  bool line_belt_stopped = false;
  bool register_belt_stopped = false;
  bool robot_clear = false;
  bool plc_silent = false;
  ResultCode device_code = ResultCode::kOk;  // why camera, trigger or a thread cannot work at this moment
  ResultCode model_code = ResultCode::kOk;   // why the active recipe cannot be run
  bool model_changed = false;                // since the last step
  std::int64_t capture_time_us = 0;          // what the active recipe's sequence takes
  bool workers_idle = true;                  // neither capture nor processing is still winding down
  CaptureOutcome capture;
  LocateOutcome locate;
  std::uint16_t command = 0;  // a PlcCommand not yet answered; 0 none
  std::uint16_t command_argument = 0;
  bool recipe_known = false;  // whether command_argument numbers a recipe, for kSelectRecipe
};

enum class ActionKind : std::uint8_t {
  kStartCapture,     // number: the capture's
  kAbortCapture,     // number: the capture's; code: why
  kStartProcessing,  // number: the capture's
  kOfferPart,        // part: index into LocateOutcome::parts; number: the offer's sequence number
  kRevokeOffer,      // number: the offer's; code: why, kOk when the PLC has answered it
  kSwitchRecipe,     // number: the recipe's
  kAnswerCommand,    // number: the command; code: its result
};

struct Action {
  ActionKind kind{};
  ResultCode code = ResultCode::kOk;
  std::uint16_t number = 0;
  int part = -1;
};

// What one step decided, to be carried out in order.
class Actions {
 public:
  void add(const Action& action);
  [[nodiscard]] std::span<const Action> list() const { return {list_.data(), static_cast<std::size_t>(count_)}; }

 private:
  std::array<Action, 32> list_{};
  int count_ = 0;
};

// The levels after a step, as the registers show them.
struct CycleStatus {
  CellState state = CellState::kStarting;
  ResultCode fault_code = ResultCode::kOk;
  ResultCode last_code = ResultCode::kOk;
  std::uint16_t cycle = 0;
  std::uint16_t capture = 0;
  std::uint16_t offer_sequence = 0;  // of the part on offer, else of the last one
  int offered_part = -1;
  int parts_left = 0;
  int withheld = 0;
  ResultCode withheld_code = ResultCode::kOk;

  [[nodiscard]] bool pose_valid() const { return state == CellState::kOffering; }
  [[nodiscard]] bool belt_may_move() const { return state == CellState::kBeltReleased; }
  // ApplianceStatusBit, all of them.
  [[nodiscard]] std::uint16_t bits() const;
};

class Cycle {
 public:
  explicit Cycle(const CycleConfig& config);

  Actions step(const CycleInputs& inputs);
  [[nodiscard]] const CycleStatus& status() const { return status_; }

 private:
  void safety_events(const CycleInputs& in);
  void report_events(const CycleInputs& in);
  void timer_events(const CycleInputs& in);
  void command_events(const CycleInputs& in);
  void answer_for_offer(const CycleInputs& in, PlcCommand command);
  [[nodiscard]] ResultCode start_refusal(const CycleInputs& in) const;
  [[nodiscard]] static ResultCode clear_refusal(const CycleInputs& in);
  CycleEvent after_offer();

  Transition::Kind apply(CycleEvent event, ResultCode code, std::uint16_t number = 0);
  void end_offer(ResultCode code);
  void make_offer();
  void enter(CellState next);
  void answer(std::uint16_t command, ResultCode code);

  CycleConfig config_;
  CycleStatus status_;
  BeltSignals belt_;
  PickPlan plan_;
  std::int64_t now_us_ = 0;
  std::int64_t entered_us_ = 0;  // when the present state was entered
  std::int64_t offered_us_ = 0;
  std::uint16_t next_sequence_;
  int failed_picks_ = 0;
  Actions actions_;
};

}  // namespace beltpick::cycle
