// The server's share of a request: from its head, by way of the gate, its body and its handler, to the log.
#include <microhttpd.h>
#include <strings.h>

#include <cstring>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "service/https_server.hpp"

namespace beltpick::service {
namespace {

using Stage = Connection::Stage;

constexpr std::size_t kReadOver = std::size_t{1} << 20U;     // of a refused body; of a larger one nothing is read
constexpr std::size_t kMaxAnswers = std::size_t{16} << 20U;  // bytes waiting to be taken, of all clients

// The headers that the gate looks at.
MHD_Result read_header(void* head_of, MHD_ValueKind, const char* key, const char* value) {
  auto& head = *static_cast<RequestHead*>(head_of);
  const std::string_view text = value == nullptr ? "" : value;
  const auto take = [&](const char* name, std::string_view& into) {
    if (strcasecmp(key, name) != 0) return;
    head.doubled = head.doubled || !into.empty();
    into = text;
  };
  take("Authorization", head.authorization);
  take("Content-Length", head.content_length);
  take("Content-Type", head.content_type);
  take("If-Match", head.if_match);
  if (strcasecmp(key, "Transfer-Encoding") == 0) head.transfer_encoding = true;
  return MHD_YES;
}

}  // namespace

void HttpsServer::head_came(Connection& connection) {
  ++connection.requests;
  RequestHead head;
  head.method = connection.method;
  head.path = connection.path;
  MHD_get_connection_values(connection.handle, MHD_HEADER_KIND, &read_header, &head);
  connection.if_match = head.if_match;
  connection.admission = gate_.judge(head, connection.from, monotonic_us());
  if (connection.admission.refused) {
    connection.reply = std::move(*connection.admission.refused);
    log_answer(connection);
  } else if (connection.admission.upload && uploading_ != nullptr) {
    refuse(connection, failure(ResultCode::kServiceBusy,
                               "the upload: expected none other at the same time, found one; try again in 2 s")
                           .error());
  } else {
    if (connection.admission.upload) uploading_ = &connection;
    connection.stage = Stage::kBody;
    return;
  }
  const bool bounded = !head.transfer_encoding && connection.admission.body_bytes <= kReadOver;
  connection.stage = bounded ? Stage::kReadOver : Stage::kAnswered;
}

// The gate has bounded what is announced, and libmicrohttpd gives no more than that.
void HttpsServer::body_came(Connection& connection, const char* bytes, std::size_t count) {
  if (connection.stage != Stage::kBody) return;
  if (connection.body.size() + count > connection.admission.body_bytes) return;
  if (&connection != uploading_) {
    connection.body.append(bytes, count);
    return;
  }
  std::memcpy(upload_.data() + uploaded_, bytes, count);
  uploaded_ += count;
}

ApiRequest HttpsServer::request_of(const Connection& connection) const {
  ApiRequest request;
  request.action = connection.admission.route->action;
  request.names = connection.admission.names;
  request.caller = connection.admission.caller;
  request.body = &connection == uploading_ ? std::string_view(upload_.data(), uploaded_) : connection.body;
  request.if_match = connection.if_match;
  return request;
}

bool HttpsServer::request_came(Connection& connection) {
  if (connection.stage == Stage::kReadOver) return true;
  const ApiRequest request = request_of(connection);
  if (Api::is_slow(request.action)) {
    answer_slowly(connection, request);
    return false;
  }
  connection.reply = api_.answer(request);
  if (connection.reply.code == ResultCode::kNotAuthorized) addresses_.wrong_token(connection.from, monotonic_us());
  log_answer(connection);
  if (connections_.answer_bytes() > kMaxAnswers) {
    refuse(connection, failure(ResultCode::kServiceBusy,
                               "the download: expected few at the same time, found too many; try again in 2 s")
                           .error());
  }
  return true;
}

// libmicrohttpd asks again for the answer once the connection is resumed.
void HttpsServer::answer_slowly(Connection& connection, const ApiRequest& request) {
  MHD_suspend_connection(connection.handle);
  connection.stage = Stage::kWaits;
  const auto resume = [this, &connection] {
    connection.overdue_us = monotonic_us() + config_.request_s * 1'000'000LL;
    connection.stage = Stage::kAnswered;
    MHD_resume_connection(connection.handle);
  };
  const bool taken = slow_.add([this, &connection, request, resume] {
    connection.reply = api_.answer(request);
    log_answer(connection);
    resume();
  });
  if (taken) return;
  refuse(
      connection,
      failure(ResultCode::kServiceBusy, "the request: expected few to wait, found too many; try again in 2 s").error());
  resume();
}

void HttpsServer::finish(Connection& connection) {
  if (uploading_ == &connection) {
    uploading_ = nullptr;
    uploaded_ = 0;
  }
  Connections::next_request(connection);
  if (connection.overdue_us != Connection::kNever_us) {
    connection.overdue_us = monotonic_us() + (config_.idle_s + config_.request_s) * 1'000'000LL;
  }
}

void HttpsServer::refuse(Connection& connection, const Error& error) {
  connection.reply = refusal(error);
  log_answer(connection);
}

// Refusals, as many as the log bears, and every change.
void HttpsServer::log_answer(const Connection& connection) {
  const ApiReply& reply = connection.reply;
  const bool refused = reply.status >= 400;
  if (!refused && (connection.method == "GET" || connection.method == "HEAD")) return;
  std::string line = "service: " + connection.admission.caller.name + " from " + address_text(connection.from) + ": " +
                     connection.method.substr(0, 16) + " " + connection.path.substr(0, 100) + ": " +
                     std::to_string(reply.status);
  if (!refused) return log_(false, for_log(line));
  line += " " + std::string(result_code_name(reply.code));
  refusals_.write(for_log(line), monotonic_us());
}

}  // namespace beltpick::service
