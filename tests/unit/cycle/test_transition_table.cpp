// The table against the rules of the design, stated here as rules over all states and events, not as a second table.
#include <catch2/catch.hpp>

#include <set>

#include "cell_driver.hpp"

using namespace beltpick;
using namespace beltpick::cycle;

namespace {

constexpr auto kFirstCommand = CycleEvent::kStart;

template <class Visit>
void each_pair(Visit visit) {
  for (const CellState state : kAllStates) {
    for (std::size_t event = 0; event < kCycleEvents; ++event) {
      INFO("state " << static_cast<int>(state) << " event " << event);
      visit(state, static_cast<CycleEvent>(event), transition(state, static_cast<CycleEvent>(event)));
    }
  }
}

}  // namespace

TEST_CASE("every state answers every event; commands are done or refused, never swallowed", "[table]") {
  int visited = 0;
  each_pair([&](CellState, CycleEvent event, const Transition& to) {
    ++visited;
    if (event >= kFirstCommand) {
      CHECK(to.kind != Transition::Kind::kIgnore);
    } else {
      CHECK(to.kind != Transition::Kind::kRefuse);
    }
  });
  CHECK(visited == 8 * 28);
}

TEST_CASE("leaving 'offering', and the next offer, always ends the offer; only 'offering' has one", "[table]") {
  each_pair([](CellState state, CycleEvent event, const Transition& to) {
    if (to.kind != Transition::Kind::kGo) return;
    const bool ends_offer = (to.effects & (kEffectRevokeOffer | kEffectRetireOffer)) != 0;
    const bool makes_offer = (to.effects & kEffectOffer) != 0;
    const bool leaves = state == CellState::kOffering && to.next != CellState::kOffering;
    CHECK(ends_offer == (leaves || event == CycleEvent::kOfferNext));
    CHECK(makes_offer == (event == CycleEvent::kPartsFound || event == CycleEvent::kOfferNext));
    if (makes_offer) {
      CHECK(to.next == CellState::kOffering);
    }
    if (to.next == CellState::kOffering && state != CellState::kOffering) {
      CHECK(makes_offer);
    }
  });
}

TEST_CASE("leaving 'capturing' before its end always aborts the capture", "[table]") {
  each_pair([](CellState state, CycleEvent event, const Transition& to) {
    if (to.kind != Transition::Kind::kGo) return;
    const bool ended = event == CycleEvent::kCaptureDone || event == CycleEvent::kCaptureFailed;
    const bool leaves = state == CellState::kCapturing && to.next != CellState::kCapturing;
    CHECK(((to.effects & kEffectAbortCapture) != 0) == (leaves && !ended));
    CHECK(((to.effects & kEffectStartCapture) != 0) == (event == CycleEvent::kSettled));
    CHECK(((to.effects & kEffectStartProcessing) != 0) == (event == CycleEvent::kCaptureDone));
  });
}

TEST_CASE("every way into 'fault' latches a code; the only way out is the clear command, to 'idle'", "[table]") {
  each_pair([](CellState state, CycleEvent event, const Transition& to) {
    if (to.kind != Transition::Kind::kGo) return;
    if (state != CellState::kFault) {
      CHECK((to.next == CellState::kFault) == ((to.effects & kEffectLatchFault) != 0));
    } else {
      CHECK((to.next == CellState::kFault) == (event != CycleEvent::kClearFault));
      if (to.next != CellState::kFault) {
        CHECK(to.next == CellState::kIdle);
      }
    }
  });
}

TEST_CASE("what endangers the cell ends in 'fault' from every state in which something may happen", "[table]") {
  for (const auto event : {CycleEvent::kEmergencyStop, CycleEvent::kDeviceLost, CycleEvent::kPlcSilent}) {
    for (const CellState state : kAllStates) {
      if (state == CellState::kStarting || state == CellState::kFault) continue;
      CHECK(transition(state, event).next == CellState::kFault);
    }
  }
  for (const auto state : {CellState::kCapturing, CellState::kProcessing, CellState::kOffering}) {
    CHECK(transition(state, CycleEvent::kBeltNotHeld).next == CellState::kFault);
    CHECK(transition(state, CycleEvent::kBeltNotHeld).kind == Transition::Kind::kGo);
  }
}

TEST_CASE("the belt is released only when nothing pickable is left or the PLC gives the view up", "[table]") {
  const std::set<CycleEvent> releasing{CycleEvent::kNothingPickable, CycleEvent::kNothingLeft, CycleEvent::kEnd};
  each_pair([&](CellState state, CycleEvent event, const Transition& to) {
    if (to.kind != Transition::Kind::kGo || to.next != CellState::kBeltReleased) return;
    CHECK((releasing.contains(event) || state == CellState::kBeltReleased));
    CHECK(state != CellState::kFault);
  });
}

TEST_CASE("every state can be reached, and from every state there is a way back to 'idle'", "[table]") {
  const auto reach_from = [](CellState start) {
    std::set<CellState> seen{start};
    for (std::size_t grown = 0; grown != seen.size();) {
      grown = seen.size();
      for (const CellState state : std::set<CellState>(seen)) {
        for (std::size_t event = 0; event < kCycleEvents; ++event) {
          const Transition& to = transition(state, static_cast<CycleEvent>(event));
          if (to.kind == Transition::Kind::kGo) seen.insert(to.next);
        }
      }
    }
    return seen;
  };
  CHECK(reach_from(CellState::kStarting).size() == 8);
  for (const CellState state : kAllStates) CHECK(reach_from(state).contains(CellState::kIdle));
}
