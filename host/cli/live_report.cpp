#include "live_report.hpp"

#include <cmath>
#include <cstdio>

#include "contract/result_codes.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

std::string code_name(std::uint16_t code) { return std::string(result_code_name(static_cast<ResultCode>(code))); }

Json view_json(const virtual_cell::ViewRecord& view) {
  Json json{{"view", view.view},
            {"parts", view.parts},
            {"picked", view.picked},
            {"left", view.left},
            {"captures", view.captures},
            {"withheld", view.withheld},
            {"first_pose_ms", view.first_pose_ms},
            {"total_ms", view.total_ms}};
  if (view.left > 0) json["reason"] = view.withheld_code != 0 ? code_name(view.withheld_code) : "NOT_SEEN";
  return json;
}

Json pick_json(const virtual_cell::PickRecord& pick) {
  constexpr const char* kOutcomes[] = {"picked", "crashed", "blocked"};  // in the order of PickOutcome
  const auto rounded = [](double value) { return std::isfinite(value) ? std::round(value * 1e4) / 1e4 : value; };
  Json json{{"view", pick.view},
            {"outcome", kOutcomes[static_cast<std::size_t>(pick.result.outcome)]},
            {"position_mm", rounded(pick.result.position_mm)},
            {"angle_deg", rounded(pick.result.angle_deg)}};
  if (pick.result.outcome == virtual_cell::PickOutcome::kBlocked) json["in_the_way"] = pick.result.in_the_way;
  return json;
}

Json fault_json(const virtual_cell::FaultRecord& record) {
  const auto& entry = virtual_cell::fault_entry(record.fault);
  Json codes = Json::array();
  for (const std::uint16_t code : record.codes) codes.push_back(code_name(code));
  return {{"fault", std::string(entry.name)},
          {"view", record.view},
          {"expected", code_name(static_cast<std::uint16_t>(entry.expected))},
          {"codes", codes},
          {"answered", record.answered},
          {"recovered", record.recovered}};
}

}  // namespace

Json report_json(const virtual_cell::CellReport& report) {
  Json json{{"format", "beltpick-cell-report"},
            {"version", 1},
            {"parts", report.parts},
            {"picked", report.picked},
            {"tray", report.tray},
            {"crashes", report.crashes},
            {"blocked", report.blocked},
            {"unsafe", report.unsafe},
            {"cycles", report.views.size()},
            {"finished", report.finished}};
  if (!report.finished) json["stopped_by"] = report.stopped_by;
  Json views = Json::array();
  for (const auto& view : report.views) views.push_back(view_json(view));
  Json faults = Json::array();
  for (const auto& fault : report.faults) faults.push_back(fault_json(fault));
  json["views"] = views;
  json["picks"] = Json::array();
  for (const auto& pick : report.picks) json["picks"].push_back(pick_json(pick));
  json["faults"] = faults;
  return json;
}

std::string view_line(const virtual_cell::ViewRecord& view) {
  char line[200];
  const std::string reason =
      view.left == 0 ? ""
                     : ", to the tray " + std::to_string(view.left) + " (" +
                           (view.withheld_code != 0 ? code_name(view.withheld_code) : std::string("not seen")) + ")";
  std::snprintf(line, sizeof line,
                "stop %2d: %d parts, %d picked%s; %d captures, first pose after %.0f ms, %.1f s in all\n",
                view.view + 1, view.parts, view.picked, reason.c_str(), view.captures, view.first_pose_ms,
                view.total_ms / 1000.0);
  return line;
}

std::string report_text(const virtual_cell::CellReport& report) {
  char line[240];
  std::snprintf(line, sizeof line, "%d parts: %d picked, %d to the tray, %d crashes, %d picks blocked, in %zu stops\n",
                report.parts, report.picked, report.tray, report.crashes, report.blocked, report.views.size());
  std::string text = line;
  for (const auto& fault : report.faults) {
    std::string codes;
    for (const std::uint16_t code : fault.codes) codes += " " + code_name(code);
    text += "fault " + std::string(virtual_cell::fault_entry(fault.fault).name) + " at stop " +
            std::to_string(fault.view + 1) + ":" + (codes.empty() ? " nothing told" : codes) +
            (fault.answered ? "" : " (not as expected)") + (fault.recovered ? ", recovered" : ", NOT recovered") + "\n";
  }
  if (!report.finished) text += "not finished: " + report.stopped_by + "\n";
  return text;
}

}  // namespace beltpick::cli
