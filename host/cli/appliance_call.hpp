// What the commands that talk to an appliance share: --to, the item that is meant, and answers in JSON.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract_io/json_writer.hpp"
#include "link/appliance.hpp"

namespace beltpick::cli {

// --to HOST[:PORT], required.
void add_to(CLI::App& app, std::string& to);

// The appliance of that address, with which this user has enrolled. Errors: kUsage, kNotEnrolled, those of its file.
Result<link::Appliance> open_appliance(const std::string& to);

struct ItemWords {
  std::string kind, name;
};

// KIND, or KIND and NAME, as positional arguments.
void add_kind(CLI::App& app, std::string& kind, bool needed = true);
void add_item(CLI::App& app, ItemWords& words, bool kind_needed = true);

// The item meant. Error: kUsage, for a missing name of a template or recipe, a name that cannot be one, or a name other
// than its own for a calibration or cell.
Result<link::RouteValues> item_of(const ItemWords& words);

// "template knuckle", "calibration".
std::string item_words(const link::RouteValues& item);

// A call whose answer is JSON. Errors: those of link::Appliance::call; kFormatInvalid.
Result<contract_io::Json> ask(link::Appliance& appliance, ApiAction action, const link::RouteValues& values = {},
                              std::string_view body = {}, const link::Progress& progress = {});

// The value at a JSON pointer such as "/recipe/name" as text for a person; "" where there is none.
std::string words_at(const contract_io::Json& json, const char* pointer);
// The array there; empty where there is none.
contract_io::Json list_at(const contract_io::Json& json, const char* pointer);
double number_at(const contract_io::Json& json, const char* pointer);
bool flag_at(const contract_io::Json& json, const char* pointer);

// "version 3 of 2026-11-22T07:00:00Z by anna, 20480 bytes (rollback to 1)" of a VERSION of the API.
std::string version_words(const contract_io::Json& version);

}  // namespace beltpick::cli
