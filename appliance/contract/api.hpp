// The appliance's HTTPS API: who may do what, what can be uploaded, and every route once. The server serves this table,
// `beltpick` calls it, and a test holds api/openapi.json against it. Routes are a promise: they are added, not changed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace beltpick {

// Each role may do what those before it may.
enum class Role : std::uint8_t {
  kNobody,        // no token at all
  kViewer,        // looks
  kOperator,      // runs the self-test
  kCommissioner,  // changes what the cell works with, and who may
};

inline constexpr auto kRoleNames =
    std::to_array<std::string_view>({"nobody", "viewer", "operator", "commissioner"});  // by Role

constexpr std::string_view role_name(Role role) { return kRoleNames[static_cast<std::size_t>(role)]; }

// What the appliance keeps in versions. There is one calibration and one cell, whose name is that of their kind; of
// templates and recipes there are many, each with a name: letters, digits, '.', '_', '-', at most kMaxItemName, the
// first a letter or digit. A recipe names its templates by these names.
enum class ItemKind : std::uint8_t { kCalibration, kCell, kTemplate, kRecipe };

struct ItemKindEntry {
  ItemKind kind;
  std::string_view name;       // in paths and commands
  std::string_view extension;  // of its file
  bool single;
  std::size_t max_bytes;
};

inline constexpr std::size_t kMaxItemName = 64;

inline constexpr auto kItemKinds = std::to_array<ItemKindEntry>({
    {ItemKind::kCalibration, "calibration", ".json", true, std::size_t{1} << 20U},
    {ItemKind::kCell, "cell", ".json", true, std::size_t{1} << 16U},
    {ItemKind::kTemplate, "template", ".template", false, std::size_t{4} << 20U},
    {ItemKind::kRecipe, "recipe", ".json", false, std::size_t{1} << 18U},
});

constexpr const ItemKindEntry& item_kind(ItemKind kind) { return kItemKinds[static_cast<std::size_t>(kind)]; }

constexpr std::optional<ItemKind> find_item_kind(std::string_view name) {
  for (const ItemKindEntry& entry : kItemKinds) {
    if (entry.name == name) return entry.kind;
  }
  return std::nullopt;
}

constexpr bool is_item_name(std::string_view name) {
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); };
  if (name.empty() || name.size() > kMaxItemName || !plain(name.front())) return false;
  for (const char c : name) {
    if (!plain(c) && c != '.' && c != '_' && c != '-') return false;
  }
  return true;
}

enum class HttpMethod : std::uint8_t { kGet, kPut, kPost, kDelete };

enum class ApiAction : std::uint8_t {
  kHealth,
  kOpenApi,
  kEnrol,
  kStatus,
  kListResultCodes,
  kSelfTest,
  kRunSelfTest,
  kListItems,
  kDownload,
  kUpload,
  kRemove,
  kListVersions,
  kDownloadVersion,
  kRollback,
  kListTokens,
  kMakeToken,
  kRevokeToken,
};

struct ApiRoute {
  HttpMethod method;
  std::string_view path;  // {kind}, {name}, {version} stand for one segment each
  ApiAction action;
  Role role;  // the least that may
  std::string_view summary;
};

inline constexpr std::uint16_t kDefaultServicePort = 8443;
inline constexpr std::size_t kMaxJsonBody = 4096;  // of requests other than uploads

// Bodies and answers are JSON except the items themselves, which are their files' bytes. Members may be added.
//   CODE          {"code": 18, "name": "CHECKSUM_WRONG", "cause": ..., "remedy": ...}
//   a refusal     CODE with "detail": one line, what, where, expected, found; with status 429 also "retry_after_s"
//   VERSION       {"version": 3, "sha256", "bytes", "time", "by", "origin", "removed"}, time in UTC as ISO 8601
//   health        {"product": "beltpickd", "version": "0.1.0", "time"}
//   enrol         {"token": the one-time one, "name": who enrols} -> {"token", "name", "role"}
//   status        {"state", "last_code": CODE, "fault": CODE or null, "model": CODE or null,
//                  "recipe": {"number", "name"}, "in_use": [{"kind", "name", "version"}],
//                  "camera": {"ready", "serial"}, "trigger": {"ready"}, "plc": {"connected"},
//                  "pixels": {"valid", "dark", ..}, "belt_nearer_mm": than the cell file has it, or null,
//                  "counters": {"cycles", "captures", "offers", "picked", "faults"}, "uptime_s",
//                  "memory_mb": {"budget", "resident"}, "time", "version", "role": the asker's}
//   result-codes  {"result_codes": [CODE...]}
//   self-test     as service/self_test_text.hpp writes it; checks are empty before the first
//   items         {"items": [{"kind", "name", "current": VERSION, "in_use": version or null}]}
//   upload        VERSION with "warnings": [text...];  remove and rollback: VERSION
//   versions      {"kind", "name", "versions": [VERSION...]}, oldest first
//   tokens        {"tokens": [{"name", "role", "time"}]};  make: {"name", "role"} -> {"token", "name", "role"};
//                 revoke: {"name"}
// A downloaded item comes with its version in the header kVersionHeader.
inline constexpr std::string_view kVersionHeader = "Beltpick-Version";

inline constexpr auto kApiRoutes = std::to_array<ApiRoute>({
    {HttpMethod::kGet, "/api/v1/health", ApiAction::kHealth, Role::kNobody, "product, version, and that it answers"},
    {HttpMethod::kGet, "/api/v1/openapi.json", ApiAction::kOpenApi, Role::kNobody, "this API as an OpenAPI document"},
    {HttpMethod::kPost, "/api/v1/enrol", ApiAction::kEnrol, Role::kNobody,
     "trades the one-time token for a commissioner's token"},
    {HttpMethod::kGet, "/api/v1/status", ApiAction::kStatus, Role::kViewer,
     "state of the cell, fault, models in use, counters, memory"},
    {HttpMethod::kGet, "/api/v1/result-codes", ApiAction::kListResultCodes, Role::kViewer,
     "every result code with cause and remedy"},
    {HttpMethod::kGet, "/api/v1/self-test", ApiAction::kSelfTest, Role::kViewer, "the last self-test"},
    {HttpMethod::kPost, "/api/v1/self-test", ApiAction::kRunSelfTest, Role::kOperator, "runs the self-test"},
    {HttpMethod::kGet, "/api/v1/items", ApiAction::kListItems, Role::kViewer,
     "all items with their current versions and which are in use"},
    {HttpMethod::kGet, "/api/v1/items/{kind}/{name}", ApiAction::kDownload, Role::kViewer, "the current version"},
    {HttpMethod::kPut, "/api/v1/items/{kind}/{name}", ApiAction::kUpload, Role::kCommissioner,
     "a new version, checked before it is taken"},
    {HttpMethod::kDelete, "/api/v1/items/{kind}/{name}", ApiAction::kRemove, Role::kCommissioner,
     "takes a template or recipe out of use; its versions stay"},
    {HttpMethod::kGet, "/api/v1/items/{kind}/{name}/versions", ApiAction::kListVersions, Role::kViewer,
     "the versions that are kept"},
    {HttpMethod::kGet, "/api/v1/items/{kind}/{name}/versions/{version}", ApiAction::kDownloadVersion, Role::kViewer,
     "an older version"},
    {HttpMethod::kPost, "/api/v1/items/{kind}/{name}/rollback", ApiAction::kRollback, Role::kCommissioner,
     "makes an older version, {\"version\": n} or the one before, current again"},
    {HttpMethod::kGet, "/api/v1/tokens", ApiAction::kListTokens, Role::kCommissioner,
     "names and roles, not the tokens"},
    {HttpMethod::kPost, "/api/v1/tokens", ApiAction::kMakeToken, Role::kCommissioner,
     "a token for {\"name\": ..., \"role\": ...}"},
    {HttpMethod::kDelete, "/api/v1/tokens/{name}", ApiAction::kRevokeToken, Role::kCommissioner, "revokes a token"},
});

}  // namespace beltpick
