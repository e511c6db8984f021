// The API's handlers of what the store keeps.
#include <algorithm>
#include <charconv>

#include "contract/result_codes.hpp"
#include "contract_io/json_reader.hpp"
#include "service/api.hpp"
#include "service/forms.hpp"
#include "service/gate.hpp"

namespace beltpick::service {
namespace {

using contract_io::Json;
using contract_io::json_text;

ApiReply json_reply(const Json& json, unsigned status = 200) {
  ApiReply reply;
  reply.status = status;
  reply.body = json_text(json);
  return reply;
}

Result<std::uint32_t> version_of(std::string_view text) {
  std::uint32_t version = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), version);
  if (error == std::errc() && end == text.data() + text.size() && version > 0) return version;
  return failure(ResultCode::kRouteUnknown, "the version: expected a number from 1, found another text; see versions");
}

// The version that a rollback's body names; nothing where it names none.
Result<std::optional<std::uint32_t>> wanted_version(std::string_view body) {
  if (body.empty()) return std::nullopt;
  contract_io::Warnings warnings;
  contract_io::JsonDocument document(body, "request", warnings);
  contract_io::JsonObject message = document.message();
  std::optional<std::uint32_t> version;
  if (message.has("version")) version = static_cast<std::uint32_t>(message.integer("version", {1, 2e9}));
  if (document.failed()) return document.error();
  return version;
}

// Whether If-Match, `"<sha256>"` or `*`, names what is there.
bool is_expected(std::string_view if_match, const std::optional<VersionInfo>& current) {
  if (if_match.empty()) return true;
  if (!current) return false;
  return if_match == "*" || if_match == "\"" + current->sha256 + "\"";
}

}  // namespace

ApiReply Api::list_items() {
  const CellStatus cell = cell_.status();
  Json items = Json::array();
  for (const ItemId& id : store_.list()) {
    const auto current = store_.current(id);
    if (!current) continue;
    const auto used =
        std::find_if(cell.in_use.begin(), cell.in_use.end(), [&](const ItemInUse& item) { return item.id == id; });
    items.push_back({{"kind", item_kind(id.kind).name},
                     {"name", id.name},
                     {"current", version_json(*current)},
                     {"in_use", used == cell.in_use.end() ? Json() : Json(used->version)}});
  }
  return json_reply({{"items", items}});
}

ApiReply Api::download(const ApiRequest& request, bool named_version) {
  const auto id = item_of(request.names);
  if (!id) return refusal(id.error());
  std::optional<std::uint32_t> wanted;
  if (named_version) {
    const auto version = version_of(request.names.version);
    if (!version) return refusal(version.error());
    wanted = *version;
  }
  auto found = store_.get(*id, wanted);
  if (!found) {
    ApiReply reply = refusal(found.error());
    if (found.error().code == ResultCode::kChecksumWrong) reply.status = http_status(ResultCode::kInternal);
    return reply;
  }
  ApiReply reply;
  reply.body = std::move(found->bytes);
  if (id->kind == ItemKind::kTemplate) reply.content_type = "application/octet-stream";
  reply.etag = found->info.sha256;
  reply.version = found->info.version;
  return reply;
}

ApiReply Api::upload(const ApiRequest& request) {
  const auto id = item_of(request.names);
  if (!id) return refusal(id.error());
  if (!is_expected(request.if_match, store_.current(*id))) {
    return refusal(failure(ResultCode::kVersionChanged,
                           "%s: expected the version that If-Match names to be current, found another; download it "
                           "again and repeat the change on it",
                           id->name.c_str())
                       .error());
  }
  return take(*id, request.body, request.caller, "upload");
}

// Judged, stored, told to the cell: the one way by which an item changes.
ApiReply Api::take(const ItemId& id, std::string_view bytes, const Caller& caller, const std::string& origin) {
  std::vector<std::string> warnings;
  if (const auto good = cell_.judge(id, bytes, warnings); !good) return refusal(good.error());
  const auto before = store_.current(id);
  const auto info = store_.put(id, bytes, caller.name, origin);
  if (!info) return refusal(info.error());
  const bool is_new = !before || before->version != info->version;
  if (is_new) cell_.changed(id);
  Json json = version_json(*info);
  json["warnings"] = warnings;
  ApiReply reply = json_reply(json, is_new ? 201 : 200);
  reply.etag = info->sha256;
  reply.version = info->version;
  return reply;
}

ApiReply Api::remove(const ApiRequest& request) {
  const auto id = item_of(request.names);
  if (!id) return refusal(id.error());
  if (store_.current(*id)) {
    if (const auto dispensable = cell_.judge_removal(*id); !dispensable) return refusal(dispensable.error());
  }
  const auto info = store_.remove(*id, request.caller.name);
  if (!info) return refusal(info.error());
  cell_.changed(*id);
  return json_reply(version_json(*info));
}

ApiReply Api::list_versions(const ApiRequest& request) {
  const auto id = item_of(request.names);
  if (!id) return refusal(id.error());
  const auto versions = store_.versions(*id);
  if (versions.empty()) return refusal(store_.get(*id).error());
  Json list = Json::array();
  for (const VersionInfo& info : versions) list.push_back(version_json(info));
  return json_reply({{"kind", item_kind(id->kind).name}, {"name", id->name}, {"versions", list}});
}

ApiReply Api::roll_back(const ApiRequest& request) {
  const auto id = item_of(request.names);
  if (!id) return refusal(id.error());
  const auto wanted = wanted_version(request.body);
  if (!wanted) return refusal(wanted.error());
  const auto version = *wanted ? Result<std::uint32_t>(**wanted) : store_.previous(*id);
  if (!version) return refusal(version.error());
  const auto older = store_.get(*id, *version);
  if (!older) return refusal(older.error());
  return take(*id, older->bytes, request.caller, "rollback to " + std::to_string(*version));
}

}  // namespace beltpick::service
