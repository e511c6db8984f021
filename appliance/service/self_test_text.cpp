#include "service/self_test_text.hpp"

#include <algorithm>
#include <array>

#include "contract_io/json_writer.hpp"

namespace beltpick::service {

namespace {

constexpr std::size_t kVerdictColumn = 10;

std::string padded(std::string_view text, std::size_t width) {
  std::string out(text);
  out.resize(std::max(width, out.size() + 1), ' ');
  return out;
}

contract_io::Json empty_report() {
  contract_io::Json json;
  json["format"] = "beltpick-self-test";
  json["version"] = 1;
  json["time"] = nullptr;
  json["worst"] = nullptr;
  json["checks"] = contract_io::Json::array();
  return json;
}

}  // namespace

std::string self_test_json_before_any() { return contract_io::json_text(empty_report()); }

std::string self_test_json(const SelfTestReport& report) {
  contract_io::Json json = empty_report();
  json["time"] = report.time_utc;
  json["worst"] = std::string(verdict_name(report.worst()));
  for (const Check& check : report.checks) {
    contract_io::Json entry;
    entry["name"] = check.name;
    entry["verdict"] = std::string(verdict_name(check.verdict));
    entry["found"] = check.found;
    entry["cause"] = check.cause;
    entry["remedy"] = check.remedy;
    json["checks"].push_back(std::move(entry));
  }
  return contract_io::json_text(json);
}

std::string self_test_table(const SelfTestReport& report) {
  std::size_t name_column = 0;
  for (const Check& check : report.checks) name_column = std::max(name_column, check.name.size() + 2);
  const std::string indent(kVerdictColumn + name_column, ' ');
  std::array<int, 4> counts{};
  std::string text;
  for (const Check& check : report.checks) {
    ++counts[static_cast<std::size_t>(check.verdict)];
    text += padded(verdict_name(check.verdict), kVerdictColumn) + padded(check.name, name_column) + check.found + "\n";
    if (!check.cause.empty()) text += indent + "cause:  " + check.cause + "\n";
    if (!check.remedy.empty()) text += indent + "remedy: " + check.remedy + "\n";
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    text += (i == 0 ? "" : ", ") + std::to_string(counts[i]) + " " + std::string(verdict_name(static_cast<Verdict>(i)));
  }
  return text + "\n";
}

}  // namespace beltpick::service
