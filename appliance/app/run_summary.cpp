// The summary of a run as JSON; apart from run_book.cpp because JSON is slow to compile.
#include <cmath>
#include <cstdio>
#include <fstream>

#include "app/run_book.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::app {

namespace {

using contract_io::Json;

double megabytes(std::size_t bytes) { return std::round(static_cast<double>(bytes) / 1e4) / 100.0; }

// A line "name:   12345 kB" of /proc/self/status.
double status_mb(const char* name) {
  std::ifstream status("/proc/self/status");
  const std::string wanted = std::string(name) + ":";
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(wanted)) return std::round(std::stod(line.substr(wanted.size())) * 1.024 / 10.0) / 100.0;
  }
  return 0.0;
}

Json codes_json(const std::vector<RunBook::Count>& codes) {
  Json json = Json::object();
  for (const auto& entry : codes) json[std::string(result_code_name(entry.code))] = entry.count;
  return json;
}

Json budget_json(std::span<const Arena::Share> budget) {
  Json shares = Json::object();
  std::size_t total = 0;
  for (const Arena::Share& share : budget) {
    shares[share.name] = megabytes(share.bytes);
    total += share.bytes;
  }
  return {{"total_mb", megabytes(total)}, {"shares_mb", shares}};
}

}  // namespace

double resident_mb() { return status_mb("VmRSS"); }
double peak_resident_mb() { return status_mb("VmHWM"); }

std::string summary_text(const RunBook& book, std::span<const Arena::Share> budget) {
  const RunBook::Totals totals = book.totals();
  Json json;
  json["cycles"] = totals.cycles;
  json["captures"] = totals.captures;
  json["failed_captures"] = totals.failed_captures;
  json["parts_found"] = totals.found;
  json["offers"] = totals.offers;
  json["picked"] = totals.picked;
  json["failed_picks"] = totals.failed_picks;
  json["withheld"] = codes_json(totals.withheld);
  json["faults"] = codes_json(totals.faults);
  json["stage_ms"] = Json::object();
  for (std::size_t step = 0; step < kSteps; ++step) {
    json["stage_ms"][step_name(static_cast<Step>(step))] = std::round(totals.median_ms[step] * 100.0) / 100.0;
  }
  json["rss_mb"] = resident_mb();
  json["peak_rss_mb"] = peak_resident_mb();
  json["budget"] = budget_json(budget);
  return json.dump() + "\n";
}

Result<void> write_summary(const std::filesystem::path& path, const RunBook& book,
                           std::span<const Arena::Share> budget) {
  return contract_io::write_file(path, summary_text(book, budget));
}

}  // namespace beltpick::app
