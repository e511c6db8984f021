#include "link/appliance.hpp"

#include <algorithm>
#include <stdexcept>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::link {
namespace {

using contract_io::Json;

const ApiRoute& route_of(ApiAction action) {
  const auto* route =
      std::find_if(kApiRoutes.begin(), kApiRoutes.end(), [&](const auto& r) { return r.action == action; });
  if (route == kApiRoutes.end()) throw std::logic_error("an action without a route");
  return *route;
}

void fill(std::string& path, std::string_view brace, const std::string& value) {
  if (const std::size_t at = path.find(brace); at != std::string::npos) path.replace(at, brace.size(), value);
}

std::string text_member(const Json& object, const char* member) {
  const auto found = object.is_object() ? object.find(member) : object.end();
  return found != object.end() && found->is_string() ? contract_io::one_line(found->get<std::string>()) : "";
}

// The code of an answer that does not tell one.
ResultCode code_of_status(int status) {
  switch (status) {
    case 401:
      return ResultCode::kNotAuthorized;
    case 403:
      return ResultCode::kRoleTooLow;
    case 404:
      return ResultCode::kFileNotFound;
    case 413:
      return ResultCode::kLimitExceeded;
    case 429:
      return ResultCode::kTooManyRequests;
    default:
      return ResultCode::kServiceUnreachable;
  }
}

// "what, where, expected, found; remedy" of a refusal; the remedy is added where the detail does not tell one.
std::unexpected<Error> refusal(const Address& address, const HttpAnswer& answer) {
  const Json body = Json::parse(answer.body, nullptr, false);
  ResultCode code = code_of_status(answer.status);
  if (body.is_object() && body.contains("code") && body["code"].is_number_unsigned()) {
    code = static_cast<ResultCode>(body["code"].get<unsigned>());
  }
  std::string detail = text_member(body, "detail");
  if (detail.empty()) {
    detail = "expected beltpick's API, found HTTP status " + std::to_string(answer.status) + "; is it an appliance?";
  }
  if (const std::string remedy = text_member(body, "remedy");
      detail.find(';') == std::string::npos && !remedy.empty()) {
    detail += "; " + remedy;
  }
  if (answer.retry_after_s && detail.find("wait ") == std::string::npos) {
    detail += "; try again in " + std::to_string(*answer.retry_after_s) + " s";
  }
  return failure(code, "%s: %s", address.text().c_str(), detail.c_str());
}

Result<HttpAnswer> accepted(const Address& address, Result<HttpAnswer> answer) {
  if (!answer || (answer->status >= 200 && answer->status < 300)) return answer;
  return refusal(address, *answer);
}

}  // namespace

std::string route_path(ApiAction action, const RouteValues& values) {
  std::string path(route_of(action).path);
  fill(path, "{kind}", values.kind);
  fill(path, "{name}", values.name);
  fill(path, "{version}", values.version);
  return path;
}

Result<KnownAppliance> enrol(const Address& address, const Fingerprint& fingerprint, const std::string& one_time_token,
                             const std::string& name) {
  HttpClient client(address, fingerprint);
  const std::string body = Json{{"token", one_time_token}, {"name", name}}.dump();
  const auto answer = accepted(
      address, client.send({.method = HttpMethod::kPost, .path = route_path(ApiAction::kEnrol), .body = body}));
  if (!answer) return std::unexpected(answer.error());
  const Json json = Json::parse(answer->body, nullptr, false);
  KnownAppliance known{
      address, fingerprint, text_member(json, "token"), text_member(json, "name"), text_member(json, "role"), {}};
  if (!known.token.empty()) return known;
  return failure(ResultCode::kFormatInvalid, "%s: enrol: expected a token in the answer, found none; update beltpick",
                 address.text().c_str());
}

Appliance::Appliance(KnownAppliance known) : known_(std::move(known)), client_(known_.address, known_.fingerprint) {}

Result<Appliance> Appliance::at(const Address& address) {
  const auto appliances = KnownAppliances::of_this_user();
  if (!appliances) return std::unexpected(appliances.error());
  auto known = appliances->find(address);
  if (!known) return std::unexpected(known.error());
  return Appliance(std::move(*known));
}

Result<HttpAnswer> Appliance::call(ApiAction action, const RouteValues& values, std::string_view body,
                                   const Progress& progress) {
  const bool binary = action == ApiAction::kUpload && values.kind == item_kind(ItemKind::kTemplate).name;
  return accepted(known_.address,
                  client_.send({.method = route_of(action).method,
                                .path = route_path(action, values),
                                .token = known_.token,
                                .body = body,
                                .content_type = binary ? "application/octet-stream" : "application/json"},
                               progress));
}

}  // namespace beltpick::link
