// StartByLine: the microcontroller, started by its START pin instead of by a message, where that pin is wired to a GPIO
// line of this PC. BUSY, where it is wired too, proves that the pulse arrived.
#pragma once

#include "capture/lines/cell_lines.hpp"
#include "capture/trigger_source.hpp"

namespace beltpick::capture {

class StartByLine : public TriggerSource {
 public:
  // Both must outlive it. Without a START line `link` is asked for everything.
  StartByLine(TriggerSource& link, CellLines& lines) : link_(link), lines_(lines) {}

  void start() override { link_.start(); }
  [[nodiscard]] bool connected() const override { return link_.connected(); }
  [[nodiscard]] Error last_error() const override { return link_.last_error(); }
  [[nodiscard]] bool tried() const override { return link_.tried(); }
  [[nodiscard]] TriggerInputs inputs() const override { return link_.inputs(); }
  [[nodiscard]] std::optional<protocol::Identity> identity() const override { return link_.identity(); }
  [[nodiscard]] protocol::StatusReport status() const override { return link_.status(); }
  Result<void> refresh_status() override { return link_.refresh_status(); }
  Result<std::uint16_t> arm(protocol::Arm sequence) override { return link_.arm(sequence); }
  // Errors also: kLinesLost where the pulse cannot be given, or BUSY does not answer it.
  Result<void> start_sequence(std::uint16_t arm_id) override;
  Result<void> abort() override { return link_.abort(); }
  Result<void> clear() override { return link_.clear(); }
  std::optional<TriggerEvent> next_event() override { return link_.next_event(); }

 private:
  TriggerSource& link_;
  CellLines& lines_;
};

}  // namespace beltpick::capture
