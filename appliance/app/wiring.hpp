// Wiring: what arms and starts the cell's sequences, and the cell's digital lines, as the configuration says: through
// the microcontroller, on lines of this PC, or both.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/digital_lines.hpp"
#include "app/settings.hpp"
#include "capture/lines/cell_lines.hpp"
#include "capture/trigger_source.hpp"

namespace beltpick::app {

class Wiring : public DigitalLines {
 public:
  explicit Wiring(const Settings& settings);
  ~Wiring() override;

  // Takes the lines of this PC that are configured, the outputs inactive. Errors: kLineNotFound, kLineInUse.
  Result<void> open();
  // Starts the threads; after open(). Where that failed, only what works without the lines.
  void start();

  [[nodiscard]] capture::TriggerSource& trigger() { return *trigger_; }
  [[nodiscard]] const capture::TriggerSource& trigger() const { return *trigger_; }
  // True where the configuration names lines of this PC.
  [[nodiscard]] bool has_lines() const { return !shown().empty(); }
  // Once open(): "belt_stopped: line 4 of gpiochip0, input, active; ...", empty without lines.
  [[nodiscard]] std::string lines_text() const;

  // Wherever both the microcontroller and this PC read a line, both must say that it is safe.
  LineLevels read() override;
  void permit_belt(bool may_move) override { lines_.permit_belt(may_move); }

 private:
  [[nodiscard]] std::vector<capture::LineShown> shown() const;

  class ByMicrocontroller;
  class ByLines;
  struct Source;

  capture::CellLines lines_;
  std::unique_ptr<Source> source_;
  capture::TriggerSource* trigger_;
};

}  // namespace beltpick::app
