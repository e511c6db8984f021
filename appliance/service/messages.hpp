// A request of the API once it is read, and the answer to it: what the handlers see of HTTP.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/api.hpp"
#include "service/router.hpp"

namespace beltpick::service {

// Who asks.
struct Caller {
  std::string name = "nobody";  // the token's
  Role role = Role::kNobody;
};

struct ApiRequest {
  ApiAction action{};
  PathNames names;
  Caller caller;
  std::string_view body;
  std::string_view if_match;  // the ETag that an upload replaces; empty: any
};

struct ApiReply {
  unsigned status = 200;
  std::string body;
  const char* content_type = "application/json";
  std::string etag;           // of an item: its SHA-256
  std::uint32_t version = 0;  // of an item
  std::string allow;
  int retry_after_s = 0;
  ResultCode code{};  // of a refusal
};

// The HTTP status that fits a refusal.
unsigned http_status(ResultCode code);

// CODE with its "detail" and, where the client is to wait, "retry_after_s".
ApiReply refusal(const Error& error, int retry_after_s = 0);

}  // namespace beltpick::service
