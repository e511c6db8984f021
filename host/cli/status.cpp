// beltpick status: how a cell is doing.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "appliance_call.hpp"
#include "base/stages.hpp"
#include "commands.hpp"
#include "options.hpp"
#include "text_table.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

// What the cell's states, as the register table names them, mean to a person.
struct StateWords {
  const char* name;
  const char* meaning;
};
constexpr StateWords kStates[] = {
    {"starting", "it looks for its devices"},
    {"idle", "it waits for the PLC to start a cycle"},
    {"settling", "the belt stands, the picture comes to rest"},
    {"capturing", "patterns are projected and captured"},
    {"processing", "parts are located"},
    {"offering", "a part is offered to the robot"},
    {"belt released", "the cycle is over, the belt may move"},
    {"fault", "it waits for the fault to be mended and cleared"},
};

std::string state_words(const std::string& state) {
  for (const StateWords& known : kStates) {
    if (state == known.name) return state + ": " + known.meaning;
  }
  return state;
}

// "EMERGENCY_STOP: the emergency stop is pressed; release it and clear the fault"; "none" without a code.
std::string code_words(const Json& status, const std::string& member) {
  const auto part = [&](const char* name) { return words_at(status, ("/" + member + "/" + name).c_str()); };
  if (part("name").empty()) return "none";
  return part("name") + ": " + part("cause") + (part("remedy").empty() ? "" : "; " + part("remedy"));
}

std::string duration_words(double seconds) {
  const long minutes = std::lround(std::floor(seconds / 60));
  if (minutes < 1) return std::to_string(std::lround(seconds)) + " s";
  if (minutes < 120) return std::to_string(minutes) + " min";
  if (minutes < 48 * 60) return std::to_string(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
  return std::to_string(minutes / (24 * 60)) + " days";
}

std::string used_words(const Json& status) {
  std::string text;
  for (const Json& item : list_at(status, "/in_use")) {
    text += (text.empty() ? "" : ", ") + item_words({words_at(item, "/kind"), words_at(item, "/name"), {}}) + " " +
            words_at(item, "/version");
  }
  return text.empty() ? "nothing" : text;
}

std::string counter_words(const Json& status) {
  std::string text;
  for (const char* counter : {"cycles", "captures", "offers", "picked", "faults"}) {
    text +=
        (text.empty() ? "" : ", ") + words_at(status, (std::string("/counters/") + counter).c_str()) + " " + counter;
  }
  return text;
}

std::string belt_words(const Json& status) {
  const auto nearer = status.find("belt_nearer_mm");
  if (nearer == status.end() || !nearer->is_number()) return "too little seen of it yet";
  const double nearer_mm = nearer->get<double>();
  char text[80];
  std::snprintf(text, sizeof text, "%.2f mm %s than the cell file has it", std::abs(nearer_mm),
                nearer_mm < 0.0 ? "farther" : "nearer");
  return text;
}

// "89.9 % measured, 8.4 % low modulation, 1.1 % dark": of the latest capture's pixels, what is worth a word.
std::string pixel_words(const Json& status) {
  const auto count = [&](std::string_view state) {
    return number_at(status, ("/pixels/" + std::string(state)).c_str());
  };
  double all = 0.0;
  for (const std::string_view state : kPixelStateNames) all += count(state);
  if (all == 0.0) return "nothing yet";
  std::string text;
  for (const std::string_view state : kPixelStateNames) {
    const double percent = 100.0 * count(state) / all;
    if (percent < 0.05 && !text.empty()) continue;
    char part[48];
    std::snprintf(part, sizeof part, "%s%.1f %% %s", text.empty() ? "" : ", ", percent,
                  text.empty() ? "measured" : std::string(state).c_str());
    text += part;
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string camera_words(const Json& status) {
  const std::string serial = words_at(status, "/camera/serial");
  return std::string(flag_at(status, "/camera/ready") ? "ready" : "not ready") + (serial.empty() ? "" : ", " + serial);
}

std::string recipe_words(const Json& status) {
  if (number_at(status, "/recipe/number") < 1) return "none";  // the PLC counts from 1
  return words_at(status, "/recipe/number") + " " + words_at(status, "/recipe/name");
}

std::string memory_words(const Json& status) {
  const auto mb = [&](const char* member) { return std::to_string(std::lround(number_at(status, member))) + " MB"; };
  return mb("/memory_mb/budget") + " taken at start, " + mb("/memory_mb/resident") + " in all";
}

std::string status_text(const Json& status, const link::Address& address) {
  return address.text() + ", beltpickd " + words_at(status, "/version") + ", up " +
         duration_words(number_at(status, "/uptime_s")) + "\n" +
         text_table({{"cell", state_words(words_at(status, "/state"))},
                     {"fault", code_words(status, "fault")},
                     {"last answer", code_words(status, "last_code")},
                     {"hindrance", code_words(status, "model")},
                     {"recipe", recipe_words(status)},
                     {"in use", used_words(status)},
                     {"camera", camera_words(status)},
                     {"trigger box", flag_at(status, "/trigger/ready") ? "ready" : "not ready"},
                     {"PLC", flag_at(status, "/plc/connected") ? "connected" : "not connected"},
                     {"last image", pixel_words(status)},
                     {"belt", belt_words(status)},
                     {"so far", counter_words(status)},
                     {"memory", memory_words(status)},
                     {"your role", words_at(status, "/role")}},
                    2);
}

Result<void> run(const std::string& to, Session& session) {
  auto appliance = open_appliance(to);
  if (!appliance) return std::unexpected(appliance.error());
  const auto status = ask(*appliance, ApiAction::kStatus);
  if (!status) return std::unexpected(status.error());
  session.answer(*status, status_text(*status, appliance->known().address));
  return {};
}

}  // namespace

Run add_status(CLI::App& app) {
  const auto to = std::make_shared<std::string>();
  add_to(app, *to);
  example(app, "  beltpick status --to cell4.local\n  beltpick status --to cell4.local --json");
  return [to](Session& session) { return run(*to, session); };
}

}  // namespace beltpick::cli
