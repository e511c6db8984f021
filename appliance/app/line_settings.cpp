#include "app/line_settings.hpp"

#include <array>

#include "contract/result_codes.hpp"
#include "contract_io/toml_config.hpp"

namespace beltpick::app {

namespace {

enum class Need : std::uint8_t { kFree, kRequired, kUseless };

struct LineKey {
  const char* key;
  const std::string LineSettings::*text;
  Need with_microcontroller;
  Need with_lines;  // trigger.source = "lines"
};

constexpr std::array<LineKey, 9> kLineKeys{{
    {"lines.belt_stopped", &LineSettings::belt_stopped, Need::kFree, Need::kRequired},
    {"lines.emergency_stop", &LineSettings::emergency_stop, Need::kFree, Need::kRequired},
    {"lines.belt_may_move", &LineSettings::belt_may_move, Need::kFree, Need::kFree},
    {"lines.start", &LineSettings::start, Need::kFree, Need::kUseless},
    {"lines.busy", &LineSettings::busy, Need::kFree, Need::kFree},
    {"lines.fault", &LineSettings::fault, Need::kFree, Need::kFree},
    {"lines.camera", &LineSettings::camera, Need::kUseless, Need::kRequired},
    {"lines.projector", &LineSettings::projector, Need::kUseless, Need::kRequired},
    {"lines.strobe", &LineSettings::strobe, Need::kUseless, Need::kRequired},
}};

capture::LineSpec spec(const Settings& settings, const std::string& text) {
  return capture::parse_line_spec(text, settings.lines.chip).value_or(capture::LineSpec{});
}

}  // namespace

bool triggers_by_lines(const Settings& settings) { return settings.trigger_source == "lines"; }

void judge_line_settings(const Settings& settings, contract_io::TomlConfig& toml) {
  for (const LineKey& line : kLineKeys) {
    const std::string& text = settings.lines.*line.text;
    const auto parsed = capture::parse_line_spec(text, settings.lines.chip);
    if (!parsed) {
      toml.fail(ResultCode::kValueOutOfRange, line.key, capture::kLineSpecForm, "\"" + text + "\"");
      continue;
    }
    const Need need = triggers_by_lines(settings) ? line.with_lines : line.with_microcontroller;
    const std::string source = "trigger.source = \"" + settings.trigger_source + "\"";
    if (need == Need::kRequired && !parsed->wired()) {
      toml.fail(ResultCode::kMemberMissing, line.key, "a line, as " + source + " needs it", "none");
    }
    if (need == Need::kUseless && parsed->wired()) {
      toml.fail(ResultCode::kValueOutOfRange, line.key, "none, as " + source + " has no use for it",
                "\"" + text + "\"");
    }
  }
}

// With trigger.source = "lines" BUSY and FAULT are told by this PC, not read.
capture::CellLinesConfig cell_lines_config(const Settings& settings) {
  const LineSettings& lines = settings.lines;
  capture::CellLinesConfig config;
  config.belt_stopped = spec(settings, lines.belt_stopped);
  config.emergency_stop = spec(settings, lines.emergency_stop);
  config.belt_may_move = spec(settings, lines.belt_may_move);
  config.debounce_ms = lines.debounce_ms;
  if (triggers_by_lines(settings)) return config;
  config.start = spec(settings, lines.start);
  config.busy = spec(settings, lines.busy);
  config.fault = spec(settings, lines.fault);
  return config;
}

capture::LineTriggerConfig line_trigger_config(const Settings& settings) {
  const LineSettings& lines = settings.lines;
  return {spec(settings, lines.camera), spec(settings, lines.projector), spec(settings, lines.strobe),
          spec(settings, lines.busy),   spec(settings, lines.fault),     lines.late_limit_us};
}

}  // namespace beltpick::app
