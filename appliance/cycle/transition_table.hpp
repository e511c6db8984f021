// The cell's cycle as one table: what every state does on every event. Pure data; cycle.hpp turns signals, timers and
// commands into events and the effects into actions of the hardware.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "contract/registers.hpp"

namespace beltpick::cycle {

// In the order in which they are looked at within one step: what makes the cell safe comes first.
enum class CycleEvent : std::uint8_t {
  kReady,            // the devices are there
  kEmergencyStop,    // pressed
  kDeviceLost,       // camera, trigger microcontroller or one of our own threads
  kPlcSilent,        // its heartbeat stopped
  kBeltMoving,       // line and register both say that the belt moves
  kBeltNotHeld,      // one of them does
  kSignalsDisagree,  // ... for longer than they may
  kRobotInView,      // "robot clear" is low
  kModelChanged,     // recipe, template or calibration are to be others: what was seen with these is void
  kCaptureDone,      // all frames are folded
  kCaptureFailed,
  kCaptureTimeout,
  kPartsFound,  // at least one pickable part
  kNothingPickable,
  kLocateFailed,
  kProcessingTimeout,
  kOfferExpired,   // older than max_age_ms
  kSettled,        // belt held and robot clear for settle_ms
  kModelUnusable,  // settled, but recipe, template or calibration have become such that nothing can be captured
  // Commands of the PLC whose arguments were found good; a pick or a skip becomes what is to follow it.
  kStart,
  kOfferNext,     // the next part of this view did not touch what was picked
  kCaptureAgain,  // what is left of this view may have moved or come free
  kNothingLeft,
  kPickFailed,
  kPickFailedTooOften,
  kEnd,
  kClearFault,
  kSelectRecipe,
};
inline constexpr std::size_t kCycleEvents = 28;
inline constexpr std::size_t kCellStates = 8;

// What goes with a transition, done in this order. The code that some need is the event's.
enum Effect : std::uint16_t {
  kEffectNone = 0,
  kEffectAbortCapture = 1U << 0U,
  kEffectRevokeOffer = 1U << 1U,  // with the code that tells why; never offered again
  kEffectRetireOffer = 1U << 2U,  // the PLC has answered it
  kEffectLatchFault = 1U << 3U,
  kEffectClearFault = 1U << 4U,
  kEffectNote = 1U << 5U,  // last_code becomes the event's code
  kEffectSwitchRecipe = 1U << 6U,
  kEffectBeginCycle = 1U << 7U,
  kEffectStartCapture = 1U << 8U,
  kEffectStartProcessing = 1U << 9U,
  kEffectOffer = 1U << 10U,
};

struct Transition {
  CellState next = CellState::kFault;
  std::uint16_t effects = kEffectNone;
  enum class Kind : std::uint8_t { kIgnore, kRefuse, kGo } kind = Kind::kIgnore;
};

namespace table {

constexpr Transition ignoring() { return {CellState::kFault, kEffectNone, Transition::Kind::kIgnore}; }
constexpr Transition refusing() { return {CellState::kFault, kEffectNone, Transition::Kind::kRefuse}; }
constexpr Transition go(CellState next, int effects = kEffectNone) {
  return {next, static_cast<std::uint16_t>(effects), Transition::Kind::kGo};
}

// Short names, so that the table stays a table.
inline constexpr CellState kIdl = CellState::kIdle, kSet = CellState::kSettling, kCap = CellState::kCapturing,
                           kPro = CellState::kProcessing, kOff = CellState::kOffering, kRel = CellState::kBeltReleased,
                           kFlt = CellState::kFault;
inline constexpr Transition unmoved = ignoring();
inline constexpr Transition refused = refusing();
inline constexpr Transition fault_ = go(kFlt, kEffectLatchFault);
inline constexpr Transition abort_ = go(kFlt, kEffectAbortCapture | kEffectLatchFault);
inline constexpr Transition revoke = go(kFlt, kEffectRevokeOffer | kEffectLatchFault);
inline constexpr Transition again_ = go(kSet, kEffectRevokeOffer | kEffectNote);
inline constexpr Transition begin_ = go(kSet, kEffectBeginCycle);
inline constexpr Transition end_r = go(kRel);
inline constexpr Transition ended_ = go(kRel, kEffectRevokeOffer);
inline constexpr Transition endcap = go(kRel, kEffectAbortCapture);
inline constexpr Transition capture = go(kCap, kEffectStartCapture);
inline constexpr Transition process = go(kPro, kEffectStartProcessing);
inline constexpr Transition offer_ = go(kOff, kEffectOffer);
inline constexpr Transition next_o = go(kOff, kEffectRetireOffer | kEffectOffer);
inline constexpr Transition recap_ = go(kSet, kEffectRetireOffer);
inline constexpr Transition done_r = go(kRel, kEffectRetireOffer);
inline constexpr Transition ready_ = go(kIdl, kEffectNote);
inline constexpr Transition swap_i = go(kIdl, kEffectNote);
inline constexpr Transition swap_s = go(kSet, kEffectNote);
inline constexpr Transition swap_c = go(kSet, kEffectAbortCapture | kEffectNote);
inline constexpr Transition unfit_ = go(kIdl, kEffectNote);
inline constexpr Transition swap_r = go(kRel, kEffectNote);
inline constexpr Transition pick_i = go(kIdl, kEffectSwitchRecipe);
inline constexpr Transition pick_o = go(kIdl, kEffectRevokeOffer | kEffectNote | kEffectSwitchRecipe);
inline constexpr Transition pick_r = go(kRel, kEffectSwitchRecipe);
inline constexpr Transition pick_f = go(kFlt, kEffectSwitchRecipe);
inline constexpr Transition clear_ = go(kIdl, kEffectClearFault);
inline constexpr Transition tidy_i = go(kIdl, kEffectClearFault);
inline constexpr Transition tidy_s = go(kSet, kEffectClearFault);
inline constexpr Transition tidy_c = go(kCap, kEffectClearFault);
inline constexpr Transition tidy_p = go(kPro, kEffectClearFault);
inline constexpr Transition tidy_o = go(kOff, kEffectClearFault);
inline constexpr Transition tidy_r = go(kRel, kEffectClearFault);

using Row = std::array<Transition, kCellStates>;

}  // namespace table

// Rows in the order of CycleEvent, columns in the order of CellState.
inline constexpr std::array<table::Row, kCycleEvents> kTransitions = [] {
  using namespace table;
  // clang-format off
  return std::array<Row, kCycleEvents>{{
  //                        starting  idle      settling  capturing process.  offering  released  fault
  /* kReady              */ {ready_,   unmoved,  unmoved,  unmoved,  unmoved,  unmoved,  unmoved,  unmoved},
  /* kEmergencyStop      */ {unmoved,  fault_,   fault_,   abort_,   fault_,   revoke,   fault_,   unmoved},
  /* kDeviceLost         */ {unmoved,  fault_,   fault_,   abort_,   fault_,   revoke,   fault_,   unmoved},
  /* kPlcSilent          */ {unmoved,  fault_,   fault_,   abort_,   fault_,   revoke,   fault_,   unmoved},
  /* kBeltMoving         */ {unmoved,  unmoved,  fault_,   abort_,   fault_,   revoke,   unmoved,  unmoved},
  /* kBeltNotHeld        */ {unmoved,  unmoved,  unmoved,  abort_,   fault_,   revoke,   unmoved,  unmoved},
  /* kSignalsDisagree    */ {unmoved,  unmoved,  fault_,   unmoved,  unmoved,  unmoved,  unmoved,  unmoved},
  /* kRobotInView        */ {unmoved,  unmoved,  unmoved,  abort_,   unmoved,  unmoved,  unmoved,  unmoved},
  /* kModelChanged       */ {unmoved,  swap_i,   swap_s,   swap_c,   swap_s,   again_,   swap_r,   unmoved},
  /* kCaptureDone        */ {unmoved,  unmoved,  unmoved,  process,  unmoved,  unmoved,  unmoved,  unmoved},
  /* kCaptureFailed      */ {unmoved,  unmoved,  unmoved,  fault_,   unmoved,  unmoved,  unmoved,  unmoved},
  /* kCaptureTimeout     */ {unmoved,  unmoved,  unmoved,  abort_,   unmoved,  unmoved,  unmoved,  unmoved},
  /* kPartsFound         */ {unmoved,  unmoved,  unmoved,  unmoved,  offer_,   unmoved,  unmoved,  unmoved},
  /* kNothingPickable    */ {unmoved,  unmoved,  unmoved,  unmoved,  end_r,    unmoved,  unmoved,  unmoved},
  /* kLocateFailed       */ {unmoved,  unmoved,  unmoved,  unmoved,  fault_,   unmoved,  unmoved,  unmoved},
  /* kProcessingTimeout  */ {unmoved,  unmoved,  unmoved,  unmoved,  fault_,   unmoved,  unmoved,  unmoved},
  /* kOfferExpired       */ {unmoved,  unmoved,  unmoved,  unmoved,  unmoved,  again_,   unmoved,  unmoved},
  /* kSettled            */ {unmoved,  unmoved,  capture,  unmoved,  unmoved,  unmoved,  unmoved,  unmoved},
  /* kModelUnusable      */ {unmoved,  unmoved,  unfit_,   unmoved,  unmoved,  unmoved,  unmoved,  unmoved},
  /* kStart              */ {refused,  begin_,   refused,  refused,  refused,  refused,  begin_,   refused},
  /* kOfferNext          */ {refused,  refused,  refused,  refused,  refused,  next_o,   refused,  refused},
  /* kCaptureAgain       */ {refused,  refused,  refused,  refused,  refused,  recap_,   refused,  refused},
  /* kNothingLeft        */ {refused,  refused,  refused,  refused,  refused,  done_r,   refused,  refused},
  /* kPickFailed         */ {refused,  refused,  refused,  refused,  refused,  again_,   refused,  refused},
  /* kPickFailedTooOften */ {refused,  refused,  refused,  refused,  refused,  revoke,   refused,  refused},
  /* kEnd                */ {refused,  end_r,    end_r,    endcap,   end_r,    ended_,   end_r,    refused},
  /* kClearFault         */ {refused,  tidy_i,   tidy_s,   tidy_c,   tidy_p,   tidy_o,   tidy_r,   clear_},
  /* kSelectRecipe       */ {refused,  pick_i,   pick_i,   refused,  refused,  pick_o,   pick_r,   pick_f},
  }};
  // clang-format on
}();

constexpr const Transition& transition(CellState state, CycleEvent event) {
  return kTransitions[static_cast<std::size_t>(event)][static_cast<std::size_t>(state)];
}

}  // namespace beltpick::cycle
