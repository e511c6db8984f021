#include "appliance_call.hpp"

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::cli {

using contract_io::Json;

namespace {

const Json* find_at(const Json& json, const char* pointer) {
  const Json::json_pointer at(pointer);
  return json.contains(at) ? &json.at(at) : nullptr;
}

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for (const ItemKindEntry& entry : kItemKinds) names.emplace_back(entry.name);
  return names;
}

}  // namespace

void add_to(CLI::App& app, std::string& to) {
  app.add_option(
         "--to", to,
         "the appliance: its name or address, with its port unless that is " + std::to_string(kDefaultServicePort))
      ->required()
      ->type_name("HOST[:PORT]");
}

Result<link::Appliance> open_appliance(const std::string& to) {
  const auto address = link::parse_address(to);
  if (!address) return std::unexpected(address.error());
  return link::Appliance::at(*address);
}

void add_kind(CLI::App& app, std::string& kind, bool needed) {
  app.add_option("kind", kind, "calibration, cell, template or recipe")
      ->type_name("KIND")
      ->check(CLI::IsMember(kinds()))
      ->required(needed);
}

void add_item(CLI::App& app, ItemWords& words, bool kind_needed) {
  add_kind(app, words.kind, kind_needed);
  app.add_option("name", words.name, "of a template or recipe")->type_name("NAME");
}

Result<link::RouteValues> item_of(const ItemWords& words) {
  const ItemKindEntry& entry = item_kind(*find_item_kind(words.kind));
  if (entry.single) {
    if (words.name.empty() || words.name == words.kind) return link::RouteValues{words.kind, words.kind, {}};
    return failure(ResultCode::kUsage, "%s: expected no name, found '%s': there is one only", words.kind.c_str(),
                   contract_io::one_line(words.name).substr(0, 80).c_str());
  }
  if (is_item_name(words.name)) return link::RouteValues{words.kind, words.name, {}};
  return failure(ResultCode::kUsage,
                 "%s: expected a name of letters, digits, '.', '_' and '-', at most %zu, found '%s'; 'beltpick items' "
                 "lists the names",
                 words.kind.c_str(), kMaxItemName, contract_io::one_line(words.name).substr(0, 80).c_str());
}

std::string item_words(const link::RouteValues& item) {
  return item.kind == item.name ? item.kind : item.kind + " " + item.name;
}

Result<Json> ask(link::Appliance& appliance, ApiAction action, const link::RouteValues& values, std::string_view body,
                 const link::Progress& progress) {
  const auto answer = appliance.call(action, values, body, progress);
  if (!answer) return std::unexpected(answer.error());
  Json json = Json::parse(answer->body, nullptr, false);
  if (!json.is_discarded()) return json;
  return failure(ResultCode::kFormatInvalid,
                 "%s: expected an answer in JSON, found something else; is it an appliance of beltpick?",
                 appliance.known().address.text().c_str());
}

std::string words_at(const Json& json, const char* pointer) {
  const Json* value = find_at(json, pointer);
  if (value == nullptr || value->is_null()) return {};
  return contract_io::one_line(value->is_string() ? value->get<std::string>()
                                                  : value->dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json list_at(const Json& json, const char* pointer) {
  const Json* value = find_at(json, pointer);
  return value != nullptr && value->is_array() ? *value : Json::array();
}

double number_at(const Json& json, const char* pointer) {
  const Json* value = find_at(json, pointer);
  return value != nullptr && value->is_number() ? value->get<double>() : 0.0;
}

bool flag_at(const Json& json, const char* pointer) {
  const Json* value = find_at(json, pointer);
  return value != nullptr && value->is_boolean() && value->get<bool>();
}

std::string version_words(const Json& version) {
  std::string text = "version " + words_at(version, "/version") + " of " + words_at(version, "/time") + " by " +
                     words_at(version, "/by") + ", " + words_at(version, "/bytes") + " bytes";
  const std::string origin = words_at(version, "/origin");
  return origin.empty() || origin == "upload" ? text : text + " (" + origin + ")";
}

}  // namespace beltpick::cli
