#include "service/gate.hpp"

#include <charconv>

#include "contract/result_codes.hpp"

namespace beltpick::service {
namespace {

constexpr std::string_view kBearer = "Bearer ";
constexpr int kShown = 80;  // characters of what a client sent in a message

struct Shown {
  int bytes;
  const char* text;
};
Shown shown(std::string_view text) {
  return {static_cast<int>(std::min<std::size_t>(text.size(), kShown)), text.data() == nullptr ? "" : text.data()};
}

std::unexpected<Error> too_many(const char* what, int wait_s) {
  return failure(ResultCode::kTooManyRequests, "this address: expected fewer %s, found too many; wait %d s", what,
                 wait_s);
}

// "12" -> 12; nothing for anything but digits.
std::optional<std::size_t> number_of(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_json(std::string_view type) {
  return type.empty() || type == "application/json" || type.starts_with("application/json;");
}

bool may_have_body(HttpMethod method) { return method == HttpMethod::kPut || method == HttpMethod::kPost; }

}  // namespace

Result<ItemId> item_of(const PathNames& names) {
  const auto kind = find_item_kind(names.kind);
  const auto [kind_bytes, kind_text] = shown(names.kind);
  if (!kind) {
    return failure(ResultCode::kRouteUnknown,
                   "%.*s: expected calibration, cell, template or recipe, found another kind; correct the path",
                   kind_bytes, kind_text);
  }
  const auto [name_bytes, name_text] = shown(names.name);
  if (!is_item_name(names.name) || (item_kind(*kind).single && names.name != names.kind)) {
    return failure(ResultCode::kRouteUnknown, "%.*s/%.*s: expected %s, found another name; correct the path",
                   kind_bytes, kind_text, name_bytes, name_text,
                   item_kind(*kind).single ? "the kind's name again" : "at most 64 letters, digits, '.', '_', '-'");
  }
  return ItemId{*kind, std::string(names.name)};
}

Admission Gate::judge(const RequestHead& head, const ClientAddress& from, std::int64_t now_us) {
  Admission admission;
  const auto refuse = [&](const Error& error, int wait_s = 0) { admission.refused = refusal(error, wait_s); };
  // The length first, even of what is refused: it tells how much is to be read over.
  const auto form = judge_form(head, admission);
  if (const int wait_s = addresses_.ask(from, now_us); wait_s > 0) {
    refuse(too_many("requests", wait_s).error(), wait_s);
  } else if (!form) {
    refuse(form.error());
  } else if (const auto route = judge_route(head, admission); !route) {
    refuse(route.error());
    admission.refused->allow = find_route(head.method, head.path).allow;
  } else if (const auto token = judge_token(head, admission, from, now_us); !token) {
    refuse(token.error(), addresses_.locked_for(from, now_us));
  } else if (const auto body = judge_body(head, admission); !body) {
    refuse(body.error());
  }
  return admission;
}

Result<void> Gate::judge_form(const RequestHead& head, Admission& admission) const {
  if (head.doubled) {
    return failure(ResultCode::kRequestMalformed, "the head: expected each header once, found one twice; send it once");
  }
  if (head.transfer_encoding) {
    return failure(ResultCode::kLengthRequired,
                   "the head: expected Content-Length, found Transfer-Encoding; send the length");
  }
  if (head.content_length.empty()) return {};
  const auto length = number_of(head.content_length);
  if (!length) {
    const auto [bytes, text] = shown(head.content_length);
    return failure(ResultCode::kRequestMalformed,
                   "Content-Length: expected a number of bytes, found \"%.*s\"; correct it", bytes, text);
  }
  admission.body_bytes = *length;
  return {};
}

Result<void> Gate::judge_route(const RequestHead& head, Admission& admission) const {
  const RouteMatch match = find_route(head.method, head.path);
  const auto [bytes, text] = shown(head.path);
  if (match.route != nullptr) {
    admission.route = match.route;
    admission.names = match.names;
    admission.upload = match.route->action == ApiAction::kUpload;
    return {};
  }
  const auto [method_bytes, method_text] = shown(head.method);
  if (!match.allow.empty()) {
    return failure(ResultCode::kMethodNotAllowed, "%.*s: expected %s, found %.*s; see /api/v1/openapi.json", bytes,
                   text, match.allow.c_str(), method_bytes, method_text);
  }
  return failure(ResultCode::kRouteUnknown,
                 "%.*s: expected a path of the API, found none of that name; see /api/v1/openapi.json", bytes, text);
}

Result<void> Gate::judge_token(const RequestHead& head, Admission& admission, const ClientAddress& from,
                               std::int64_t now_us) {
  const Role least = admission.route->role;
  const bool enrols = admission.route->action == ApiAction::kEnrol;  // its token comes in the body, and counts as well
  if (least == Role::kNobody && !enrols) return {};
  if (const int wait_s = addresses_.locked_for(from, now_us); wait_s > 0) return too_many("wrong tokens", wait_s);
  if (enrols) return {};
  if (!head.authorization.starts_with(kBearer)) {
    return failure(ResultCode::kNotAuthorized,
                   "Authorization: expected Bearer TOKEN, found %s; enrol first: beltpick enrol --to HOST",
                   head.authorization.empty() ? "no such header" : "something else");
  }
  const auto caller = tokens_.find(head.authorization.substr(kBearer.size()));
  if (!caller) {
    addresses_.wrong_token(from, now_us);
    return failure(ResultCode::kNotAuthorized,
                   "Authorization: expected a token made by this appliance, found another; was it revoked?");
  }
  admission.caller = *caller;
  if (caller->role >= least) return {};
  return failure(ResultCode::kRoleTooLow, "%s: expected a token of role %s, found one of role %s; use another",
                 caller->name.c_str(), role_name(least).data(), role_name(caller->role).data());
}

Result<void> Gate::judge_body(const RequestHead& head, Admission& admission) const {
  std::size_t most = may_have_body(admission.route->method) ? kMaxJsonBody : 0;
  bool type_fits = most == 0 || is_json(head.content_type);
  if (admission.upload) {
    const auto item = item_of(admission.names);
    if (!item) return std::unexpected(item.error());
    most = item_kind(item->kind).max_bytes;
    type_fits = head.content_type.empty() || head.content_type == "application/octet-stream" ||
                (item->kind != ItemKind::kTemplate && is_json(head.content_type));
    if (head.content_length.empty()) {
      return failure(ResultCode::kLengthRequired, "the head: expected Content-Length, found none; send the length");
    }
  }
  if (admission.body_bytes > most) {
    return failure(ResultCode::kBodyTooLarge, "the body: expected at most %zu bytes, found %zu; is it the right file?",
                   most, admission.body_bytes);
  }
  if (type_fits) return {};
  const auto [bytes, text] = shown(head.content_type);
  return failure(ResultCode::kMediaTypeWrong,
                 "Content-Type: expected application/%s, found \"%.*s\"; send it, or no Content-Type",
                 admission.upload ? "octet-stream or application/json" : "json", bytes, text);
}

}  // namespace beltpick::service
