#include "service/item_file.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "service/sha256.hpp"

namespace beltpick::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "beltpick-item ";
constexpr std::string_view kStart = "beltpick-item 1 ";
constexpr std::size_t kSealDigits = 64;
constexpr std::size_t kMaxText = 200;

std::string dumped(const Json& json) { return json.dump(-1, ' ', true, Json::error_handler_t::replace); }

// As it will be read again: invalid UTF-8 is replaced here already.
std::string tidy(const std::string& text) {
  return Json::parse(dumped(contract_io::one_line(std::string_view(text).substr(0, kMaxText)))).get<std::string>();
}

Json to_json(const ItemId& id, const VersionInfo& info) {
  return {{"kind", item_kind(id.kind).name},
          {"name", id.name},
          {"version", info.version},
          {"sha256", info.sha256},
          {"bytes", info.bytes},
          {"time", info.time_utc},
          {"by", info.by},
          {"origin", info.origin},
          {"removed", info.removed}};
}

// `json` bears the seal: it is what item_line() wrote, whatever program called that.
VersionInfo from_json(const Json& json) {
  VersionInfo info;
  info.version = json.at("version").get<std::uint32_t>();
  info.sha256 = json.at("sha256").get<std::string>();
  info.bytes = json.at("bytes").get<std::size_t>();
  info.time_utc = json.at("time").get<std::string>();
  info.by = json.at("by").get<std::string>();
  info.origin = json.at("origin").get<std::string>();
  info.removed = json.at("removed").get<bool>();
  return info;
}

std::unexpected<Error> not_whole(const std::string& name, const char* expected) {
  return failure(ResultCode::kChecksumWrong, "%s: expected %s, found something else: it was damaged", name.c_str(),
                 expected);
}

// The JSON of the first line after its seal was found right.
Result<std::string_view> sealed_json(std::string_view file, const std::string& name) {
  if (!file.starts_with(kStart)) {
    const std::string_view number = file.substr(std::min(file.size(), kFormat.size()), 4);
    const std::size_t digits = std::min(number.find_first_not_of("0123456789"), number.size());
    if (file.starts_with(kFormat) && digits > 0 && digits < number.size() && number[digits] == ' ') {
      return failure(ResultCode::kVersionUnsupported, "%s: expected version 1 of the form, found %s; update beltpick",
                     name.c_str(), std::string(number.substr(0, digits)).c_str());
    }
    return failure(ResultCode::kFormatInvalid, "%s: expected \"%s...\" at its start, found something else",
                   name.c_str(), std::string(kStart).c_str());
  }
  const std::size_t end = file.substr(0, kMaxItemLine).find('\n');
  const std::size_t json_at = kStart.size() + kSealDigits + 1;
  if (end == std::string_view::npos || end < json_at) return not_whole(name, "a whole first line");
  const std::string_view json = file.substr(json_at, end - json_at);
  if (file.substr(kStart.size(), kSealDigits) != sha256_hex(json) || file[json_at - 1] != ' ') {
    return not_whole(name, "the first line that its seal is of");
  }
  return json;
}

}  // namespace

std::string item_line(const ItemId& id, VersionInfo& info) {
  info.by = tidy(info.by);
  info.origin = tidy(info.origin);
  const std::string text = dumped(to_json(id, info));
  return std::string(kStart) + sha256_hex(text) + ' ' + text + '\n';
}

Result<ItemFile> parse_item(std::string_view file, const ItemId& id, std::uint32_t version, const std::string& name) {
  const Result<std::string_view> text = sealed_json(file, name);
  if (!text) return std::unexpected(text.error());
  ItemFile item;
  try {
    const Json json = Json::parse(*text);
    item.info = from_json(json);
    if (json.at("kind") != item_kind(id.kind).name || json.at("name") != id.name || item.info.version != version) {
      return failure(ResultCode::kFormatInvalid, "%s: expected this item and version, found version %u of %s %s",
                     name.c_str(), item.info.version, json.at("kind").get<std::string>().c_str(),
                     json.at("name").get<std::string>().c_str());
    }
  } catch (const Json::exception&) {
    return failure(ResultCode::kFormatInvalid, "%s: expected the members of a version, found others", name.c_str());
  }
  item.line_bytes = static_cast<std::size_t>(text->data() + text->size() - file.data()) + 1;
  const std::string_view bytes = file.substr(item.line_bytes);
  if (bytes.size() != item.info.bytes || sha256_hex(bytes) != item.info.sha256) {
    return failure(ResultCode::kChecksumWrong, "%s: expected the %zu bytes of its checksum, found %zu others: damaged",
                   name.c_str(), item.info.bytes, bytes.size());
  }
  return item;
}

}  // namespace beltpick::service
