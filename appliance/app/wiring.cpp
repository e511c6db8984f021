#include "app/wiring.hpp"

#include "app/line_settings.hpp"
#include "capture/lines/start_by_line.hpp"
#include "capture/trigger_link.hpp"

namespace beltpick::app {

namespace {

capture::TriggerConfig link_config(const Settings& settings) {
  capture::TriggerConfig config;
  config.tty = settings.trigger_tty;
  return config;
}

}  // namespace

// What drives camera and projector, and the lines that it takes for itself.
struct Wiring::Source {
  virtual ~Source() = default;
  virtual capture::TriggerSource& trigger() = 0;
  virtual Result<void> open(capture::Gpio&) { return {}; }
  [[nodiscard]] virtual std::vector<capture::LineShown> show() const { return {}; }
};

class Wiring::ByMicrocontroller : public Wiring::Source {
 public:
  ByMicrocontroller(const Settings& settings, capture::CellLines& lines)
      : link_(link_config(settings)), start_(link_, lines) {}
  capture::TriggerSource& trigger() override { return start_; }

 private:
  capture::TriggerLink link_;
  capture::StartByLine start_;
};

class Wiring::ByLines : public Wiring::Source {
 public:
  ByLines(const Settings& settings, const capture::CellLines& lines) : trigger_(line_trigger_config(settings), lines) {}
  capture::TriggerSource& trigger() override { return trigger_; }
  Result<void> open(capture::Gpio& gpio) override { return trigger_.open(gpio); }
  [[nodiscard]] std::vector<capture::LineShown> show() const override { return trigger_.show(); }

 private:
  capture::LineTrigger trigger_;
};

Wiring::Wiring(const Settings& settings) : lines_(cell_lines_config(settings)) {
  if (triggers_by_lines(settings)) {
    source_ = std::make_unique<ByLines>(settings, lines_);
  } else {
    source_ = std::make_unique<ByMicrocontroller>(settings, lines_);
  }
  trigger_ = &source_->trigger();
}

Wiring::~Wiring() = default;

Result<void> Wiring::open() {
  capture::Gpio& gpio = capture::gpio_of_this_pc();
  if (const auto opened = lines_.open(gpio); !opened) return opened;
  return source_->open(gpio);
}

void Wiring::start() {
  lines_.start();
  trigger_->start();
}

std::vector<capture::LineShown> Wiring::shown() const {
  std::vector<capture::LineShown> shown = lines_.show();
  for (const capture::LineShown& line : source_->show()) shown.push_back(line);
  return shown;
}

std::string Wiring::lines_text() const {
  std::string text;
  for (const capture::LineShown& line : shown()) {
    text += (text.empty() ? "" : "; ") + std::string(line.name) + ": line " + line.spec.line + " of " + line.spec.chip +
            (line.output ? ", output, " : ", input, ") + (line.active ? "active" : "inactive");
  }
  return text;
}

LineLevels Wiring::read() {
  const capture::TriggerInputs trigger = trigger_->inputs();
  const capture::CellInputs lines = lines_.inputs();
  return {.known = trigger.known && lines.known,
          .belt_stopped = trigger.belt_stopped && lines.belt_stopped,
          .emergency_stop = trigger.emergency_stop || lines.emergency_stop,
          .unknown_because = lines.known ? ResultCode::kTriggerLost : ResultCode::kLinesLost};
}

}  // namespace beltpick::app
