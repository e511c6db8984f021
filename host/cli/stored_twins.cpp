#include "stored_twins.hpp"

#include "appliance_call.hpp"
#include "contract_io/template_io.hpp"
#include "progress.hpp"
#include "twins/compare.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

std::vector<link::RouteValues> other_templates(const Json& items, const link::RouteValues& own) {
  std::vector<link::RouteValues> others;
  for (const Json& item : list_at(items, "/items")) {
    const link::RouteValues other{words_at(item, "/kind"), words_at(item, "/name"), {}};
    if (other.kind == own.kind && other.name != own.name) others.push_back(other);
  }
  return others;
}

Result<PartTemplate> fetch(link::Appliance& appliance, const link::RouteValues& id) {
  const auto answer = appliance.call(ApiAction::kDownload, id);
  if (!answer) return std::unexpected(answer.error());
  return contract_io::parse_template(answer->body, id.name, "template " + id.name);
}

// Empty where the two are told apart from every side.
Result<std::string> warning_of(const PartTemplate& part, const PartTemplate& other) {
  const auto whole = twins::compare_whole(part, other);
  if (!whole) return std::unexpected(whole.error());
  if (whole->kinship == twins::Kinship::kStrangers) return std::string();
  const auto found = whole->kinship == twins::Kinship::kSame ? whole : twins::compare(part, other);
  if (!found) return std::unexpected(found.error());
  return twins::worrying(*found) ? part.name + " beside " + twins::sentence(*found, other.name) : std::string();
}

}  // namespace

Result<std::vector<std::string>> stored_twins(link::Appliance& appliance, const UploadItem& item,
                                              const Session& session) {
  const auto part = contract_io::parse_template(item.bytes, item.id.name, item.file);
  if (!part) return std::unexpected(part.error());
  const auto items = ask(appliance, ApiAction::kListItems);
  if (!items) return std::unexpected(items.error());
  const auto others = other_templates(*items, item.id);
  std::vector<std::string> lines;
  Progress progress("compare " + item.id.name, static_cast<int>(others.size()), session.json);
  int done = 0;
  for (const link::RouteValues& id : others) {
    const auto other = fetch(appliance, id);
    const auto line = other ? warning_of(*part, *other) : std::unexpected(other.error());
    if (!line) {
      lines.push_back(id.name + ": not compared with " + item.id.name + ": " + line.error().detail);
    } else if (!line->empty()) {
      lines.push_back(*line);
    }
    progress.show(++done);
  }
  return lines;
}

}  // namespace beltpick::cli
