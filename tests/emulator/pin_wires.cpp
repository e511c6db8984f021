#include "emulator/pin_wires.hpp"

namespace emulator {

namespace {

using beltpick::host::InputPin;
using beltpick::host::Pin;
using beltpick::host::PinLink;
using beltpick::host::PinMessage;
using Kind = PinMessage::Kind;

Pin pin_of(Out out) {
  switch (out) {
    case Out::kCamera:
      return Pin::kCameraTrigger;
    case Out::kProjector:
      return Pin::kProjectorAdvance;
    case Out::kBusy:
      return Pin::kBusy;
    case Out::kDone:
      return Pin::kDone;
    case Out::kFault:
      break;
  }
  return Pin::kFault;
}

struct InputWire {
  In pin;
  bool active_high;
};

// As pins.hpp of the boards has them.
InputWire wire_of(InputPin input) {
  switch (input) {
    case InputPin::kStrobe:
      return {In::kStrobe, true};
    case InputPin::kEmergencyStop:
      return {In::kEmergencyStop, true};
    case InputPin::kStart:
      return {In::kStart, false};
    case InputPin::kBeltStopped:
      break;
  }
  return {In::kBeltStopped, false};
}

}  // namespace

PinWires::PinWires(Chip& chip, LiveChip& live, PinLink& link) : chip_(chip), live_(live), link_(link) {
  chip_.on_edge = [this](const PinEdge& edge) { on_edge(edge); };
  gone_ = !link_.send({Kind::kReady, 0, 0, chip_.cycle()});
}

// The chip's time stands still in here.
void PinWires::on_edge(const PinEdge& edge) {
  if (gone_) return;
  gone_ = !link_.send({Kind::kEdge, static_cast<std::uint8_t>(pin_of(edge.pin)), edge.level, edge.cycle});
  PinMessage message;
  while (!gone_) {
    gone_ = link_.receive(message, true) != PinLink::Received::kMessage;
    if (gone_ || message.kind == Kind::kGoOn) return;
    take(message);
  }
}

void PinWires::take(const PinMessage& message) {
  if (message.kind == Kind::kInput) set_input(message);
  if (message.kind == Kind::kHang) hang_wanted_ = true;  // not in the midst of an instruction
  if (message.kind == Kind::kNoise) live_.set_noise(static_cast<double>(message.cycle) * 1e-6);
  if (message.kind == Kind::kMute) live_.mute(message.level != 0);
}

void PinWires::set_input(const PinMessage& message) {
  const InputWire wire = wire_of(static_cast<InputPin>(message.pin));
  const bool high = (message.level != 0) == wire.active_high;
  chip_.at(chip_.cycle() + message.cycle, [this, wire, high] { chip_.set_pin(wire.pin, high); });
}

bool PinWires::serve() {
  PinMessage message;
  PinLink::Received received = PinLink::Received::kNothing;
  while (!gone_ && (received = link_.receive(message, false)) == PinLink::Received::kMessage) take(message);
  gone_ = gone_ || received == PinLink::Received::kGone;
  if (hang_wanted_) chip_.hang();
  hang_wanted_ = false;
  if (chip_.resets() != resets_told_) gone_ = !link_.send({Kind::kReset, 0, 0, chip_.cycle()}) || gone_;
  resets_told_ = chip_.resets();
  return !gone_;
}

}  // namespace emulator
