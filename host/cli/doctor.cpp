// beltpick doctor: finds out what hinders a cell, from this computer and on the appliance.
#include <algorithm>
#include <memory>

#include "appliance_call.hpp"
#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "doctor_checks.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

constexpr int kStepsHere = 7;  // then comes the appliance's self-test, which takes its time
constexpr const char* kVerdicts[] = {"good", "skipped", "warning", "failed"};  // from the best to the worst

std::ptrdiff_t count(const std::vector<DoctorCheck>& checks, const char* verdict) {
  return std::count_if(checks.begin(), checks.end(),
                       [&](const DoctorCheck& check) { return check.verdict == verdict; });
}

std::string worst(const std::vector<DoctorCheck>& checks) {
  for (const char* verdict : {"failed", "warning"}) {
    if (count(checks, verdict) > 0) return verdict;
  }
  return "good";
}

Json report_json(const std::vector<DoctorCheck>& checks, const link::Address& address) {
  Json list = Json::array();
  for (const DoctorCheck& check : checks) {
    list.push_back({{"side", check.side},
                    {"name", check.name},
                    {"verdict", check.verdict},
                    {"found", check.found},
                    {"cause", check.cause},
                    {"remedy", check.remedy}});
  }
  return {{"format", "beltpick-doctor"},
          {"version", 1},
          {"address", address.text()},
          {"verdict", worst(checks)},
          {"checks", list}};
}

std::string report_text(const std::vector<DoctorCheck>& checks) {
  std::string text;
  for (const DoctorCheck& check : checks) {
    char line[64];
    std::snprintf(line, sizeof line, "%-8s %-9s %-18s ", check.verdict.c_str(), check.side.c_str(), check.name.c_str());
    text += line + check.found + "\n";
    if (check.verdict == "good" || check.verdict == "skipped") continue;
    const std::string margin(19, ' ');
    if (!check.cause.empty()) text += margin + "cause:  " + check.cause + "\n";
    if (!check.remedy.empty()) text += margin + "remedy: " + check.remedy + "\n";
  }
  std::string counts;
  for (const char* verdict : kVerdicts) {
    if (const auto n = count(checks, verdict); n > 0) {
      counts += (counts.empty() ? "" : ", ") + std::to_string(n) + " " + verdict;
    }
  }
  return text + counts + "\n";
}

Result<void> run(const std::string& to, Session& session) {
  const auto address = link::parse_address(to);
  if (!address) return std::unexpected(address.error());
  std::vector<DoctorCheck> checks;
  {
    Progress bar("doctor", kStepsHere + 1, session.json);
    checks = doctor_checks(*address, [&](std::size_t, std::size_t) { bar.show(kStepsHere); });
  }
  session.answer(report_json(checks, *address), report_text(checks));
  const auto failed =
      std::find_if(checks.begin(), checks.end(), [](const auto& check) { return check.verdict == "failed"; });
  if (failed == checks.end()) return {};
  return failure(ResultCode::kCheckFailed, "%s: %td of %zu checks failed, first '%s'; do what its remedy says",
                 address->text().c_str(), count(checks, "failed"), checks.size(), failed->name.c_str());
}

}  // namespace

Run add_doctor(CLI::App& app) {
  const auto to = std::make_shared<std::string>();
  add_to(app, *to);
  example(app, "  beltpick doctor --to cell4.local");
  return [to](Session& session) { return run(*to, session); };
}

}  // namespace beltpick::cli
