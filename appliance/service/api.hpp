// Api: answers the API's requests, whatever they came by. A group of handlers a file: api_items.cpp, api_tokens.cpp,
// api_status.cpp.
#pragma once

#include <mutex>
#include <optional>

#include "service/cell_side.hpp"
#include "service/messages.hpp"
#include "service/tokens.hpp"

namespace beltpick::service {

class Api {
 public:
  Api(Store& store, CellSide& cell, TokenBook& tokens) : store_(store), cell_(cell), tokens_(tokens) {}

  // Whether an answer may take long: disk, judging an item, the self-test. Such are given one after the other.
  static bool is_slow(ApiAction action);

  // Never throws. Slow ones from one thread, all others from one thread.
  ApiReply answer(const ApiRequest& request);

 private:
  ApiReply dispatch(const ApiRequest& request);

  ApiReply list_items();
  ApiReply download(const ApiRequest& request, bool named_version);
  ApiReply upload(const ApiRequest& request);
  ApiReply take(const ItemId& id, std::string_view bytes, const Caller& caller, const std::string& origin);
  ApiReply remove(const ApiRequest& request);
  ApiReply list_versions(const ApiRequest& request);
  ApiReply roll_back(const ApiRequest& request);

  ApiReply enrol(const ApiRequest& request);
  ApiReply list_tokens();
  ApiReply make_token(const ApiRequest& request);
  ApiReply revoke_token(const ApiRequest& request);

  ApiReply health();
  ApiReply open_api();
  ApiReply status(const ApiRequest& request);
  ApiReply list_result_codes();
  ApiReply self_test();
  ApiReply run_self_test();

  Store& store_;
  CellSide& cell_;
  TokenBook& tokens_;
  std::mutex self_test_mutex_;
  std::optional<SelfTestReport> self_test_;  // the last one
};

}  // namespace beltpick::service
