// Gate: judges a request by its head, before any of its body is taken: rate, form, route, token, role, length, type.
#pragma once

#include <optional>
#include <string_view>

#include "service/address_book.hpp"
#include "service/messages.hpp"
#include "service/store.hpp"
#include "service/tokens.hpp"

namespace beltpick::service {

struct RequestHead {
  std::string_view method, path;
  std::string_view authorization, content_length, content_type, if_match;  // empty: no such header
  bool transfer_encoding = false;
  bool doubled = false;  // one of these headers came twice
};

struct Admission {
  const ApiRoute* route = nullptr;
  PathNames names;
  Caller caller;
  std::size_t body_bytes = 0;  // as announced, also where the request is refused
  bool upload = false;         // the body is an item
  std::optional<ApiReply> refused;
};

class Gate {
 public:
  Gate(const TokenBook& tokens, AddressBook& addresses) : tokens_(tokens), addresses_(addresses) {}

  Admission judge(const RequestHead& head, const ClientAddress& from, std::int64_t now_us);

 private:
  Result<void> judge_form(const RequestHead& head, Admission& admission) const;
  Result<void> judge_route(const RequestHead& head, Admission& admission) const;
  Result<void> judge_token(const RequestHead& head, Admission& admission, const ClientAddress& from,
                           std::int64_t now_us);
  Result<void> judge_body(const RequestHead& head, Admission& admission) const;

  const TokenBook& tokens_;
  AddressBook& addresses_;
};

// The item that a path names. Error: kRouteUnknown.
Result<ItemId> item_of(const PathNames& names);

}  // namespace beltpick::service
