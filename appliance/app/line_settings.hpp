// The digital lines of the configuration: judged together, and as the capture library takes them.
#pragma once

#include "app/settings.hpp"
#include "capture/lines/cell_lines.hpp"
#include "capture/lines/line_trigger.hpp"

namespace beltpick::contract_io {
class TomlConfig;
}

namespace beltpick::app {

// Tells `toml` what is wrong: a text that names no line, a line that trigger.source needs, or has no use for.
void judge_line_settings(const Settings& settings, contract_io::TomlConfig& toml);

// True where the lines drive camera and projector.
bool triggers_by_lines(const Settings& settings);

// Of settings that were judged.
capture::CellLinesConfig cell_lines_config(const Settings& settings);
capture::LineTriggerConfig line_trigger_config(const Settings& settings);

}  // namespace beltpick::app
