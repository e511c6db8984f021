#include "service/https_server.hpp"

#include <microhttpd.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <limits>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "service/listen_socket.hpp"

namespace beltpick::service {
namespace {

using Stage = Connection::Stage;

constexpr const char* kPriorities = "SECURE128:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:%SERVER_PRECEDENCE";
constexpr std::size_t kConnectionMemory = 16384;             // head of a request, and what is read of its body
constexpr std::size_t kReadOver = std::size_t{1} << 20U;     // of a refused body; of a larger one nothing is read
constexpr std::size_t kMaxAnswers = std::size_t{16} << 20U;  // waiting to be taken, of all clients
constexpr int kLook_ms = 200;                                // how often deadlines are looked at
constexpr std::int64_t kNever_us = std::numeric_limits<std::int64_t>::max();

std::size_t largest_item() {
  return std::max_element(kItemKinds.begin(), kItemKinds.end(),
                          [](const auto& a, const auto& b) { return a.max_bytes < b.max_bytes; })
      ->max_bytes;
}

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

// Of what a client sent, that which a log can bear: one line of ASCII.
std::string for_log(std::string_view text) {
  std::string line = contract_io::one_line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
  return line;
}

void add_header(MHD_Response* response, const char* name, const std::string& value) {
  if (!value.empty()) MHD_add_response_header(response, name, value.c_str());
}

MHD_Response* response_of(const ApiReply& reply) {
  MHD_Response* response =
      MHD_create_response_from_buffer(reply.body.size(), const_cast<char*>(reply.body.data()), MHD_RESPMEM_PERSISTENT);
  if (response == nullptr) return nullptr;
  add_header(response, "Content-Type", reply.content_type);
  add_header(response, "Cache-Control", "no-store");
  add_header(response, "X-Content-Type-Options", "nosniff");
  add_header(response, "X-Frame-Options", "DENY");
  add_header(response, "Referrer-Policy", "no-referrer");
  add_header(response, "Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
  add_header(response, "Allow", reply.allow);
  if (!reply.etag.empty()) add_header(response, "ETag", "\"" + reply.etag + "\"");
  if (reply.version > 0) add_header(response, kVersionHeader.data(), std::to_string(reply.version));
  if (reply.retry_after_s > 0) add_header(response, "Retry-After", std::to_string(reply.retry_after_s));
  if (reply.status == 401) add_header(response, "WWW-Authenticate", "Bearer");
  return response;
}

Connection* place_of(MHD_Connection* handle) {
  const MHD_ConnectionInfo* info = MHD_get_connection_info(handle, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
  return info == nullptr ? nullptr : static_cast<Connection*>(info->socket_context);
}

MHD_Result queue_reply(Connection& connection) {
  connection.stage = Stage::kAnswered;
  MHD_Response* response = response_of(connection.reply);
  if (response == nullptr) return MHD_NO;
  const MHD_Result queued = MHD_queue_response(connection.handle, connection.reply.status, response);
  MHD_destroy_response(response);
  return queued;
}

}  // namespace

struct HttpsServer::Glue {
  static MHD_Result on_request(void* server_of, MHD_Connection* handle, const char* url, const char* method,
                               const char*, const char* bytes, std::size_t* count, void** request_of) {
    auto& server = *static_cast<HttpsServer*>(server_of);
    Connection* connection = place_of(handle);
    if (connection == nullptr) return MHD_NO;
    if (*request_of == nullptr) {
      *request_of = connection;
      connection->method = method;
      connection->path = url;
      server.head_came(*connection);
      return connection->stage == Stage::kAnswered ? queue_reply(*connection) : MHD_YES;
    }
    if (connection->stage == Stage::kWaits) return MHD_YES;
    if (connection->stage != Stage::kAnswered && *count > 0) {
      server.body_came(*connection, bytes, *count);
      *count = 0;
      return MHD_YES;
    }
    if (connection->stage == Stage::kAnswered || server.request_came(*connection)) return queue_reply(*connection);
    return MHD_YES;
  }

  static void on_completed(void* server_of, MHD_Connection*, void** request_of, MHD_RequestTerminationCode) {
    auto& server = *static_cast<HttpsServer*>(server_of);
    if (*request_of == nullptr) return;
    server.finish(*static_cast<Connection*>(*request_of));
    *request_of = nullptr;
  }

  static void on_connection(void* server_of, MHD_Connection* handle, void** place,
                            MHD_ConnectionNotificationCode what) {
    auto& server = *static_cast<HttpsServer*>(server_of);
    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
      *place = server.opened(handle);
    } else if (*place != nullptr) {
      server.closed(*static_cast<Connection*>(*place));
    }
  }

  // Paths are taken as they come: no path of the API needs escapes.
  static std::size_t no_unescape(void*, MHD_Connection*, char* text) { return std::strlen(text); }

  [[gnu::format(printf, 2, 0)]] static void on_log(void* server_of, const char* format, va_list arguments) {
    auto& server = *static_cast<HttpsServer*>(server_of);
    std::array<char, 200> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    std::string line = for_log(text.data());
    while (line.ends_with('?') || line.ends_with(' ')) line.pop_back();
    server.refusals_.write("service: " + line, monotonic_us());
  }
};

HttpsServer::HttpsServer(const ServerConfig& config, TokenBook& tokens, Api& api, const LogLine& log,
                         const ServerBeats& beats)
    : config_(config),
      addresses_(config.requests_per_minute),
      gate_(tokens, addresses_),
      api_(api),
      log_(log),
      refusals_(log),
      beats_(beats),
      connections_(static_cast<std::size_t>(config.connections)),
      upload_(largest_item()),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      slow_(beats.slow) {}

HttpsServer::~HttpsServer() { (void)stop(std::numeric_limits<int>::max() / 2); }

Result<std::unique_ptr<HttpsServer>> HttpsServer::start(const ServerConfig& config, const Certificate& certificate,
                                                        TokenBook& tokens, Api& api, const LogLine& log,
                                                        const ServerBeats& beats) {
  std::unique_ptr<HttpsServer> server(new HttpsServer(config, tokens, api, log, beats));
  if (const auto opened = server->open(certificate); !opened) return std::unexpected(opened.error());
  server->thread_ = std::thread([&server = *server] { server.run(); });
  return server;
}

Result<void> HttpsServer::open(const Certificate& certificate) {
  auto listener = listen_on(config_.address, config_.port);
  if (!listener) return std::unexpected(listener.error());
  port_ = port_of(*listener);
  constexpr unsigned kFlags = MHD_USE_TLS | MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG;
  daemon_ = MHD_start_daemon(
      kFlags, port_, nullptr, nullptr, &Glue::on_request, this, MHD_OPTION_EXTERNAL_LOGGER, &Glue::on_log, this,
      MHD_OPTION_LISTEN_SOCKET, listener->get(), MHD_OPTION_HTTPS_MEM_KEY, certificate.key_pem.c_str(),
      MHD_OPTION_HTTPS_MEM_CERT, certificate.certificate_pem.c_str(), MHD_OPTION_HTTPS_PRIORITIES, kPriorities,
      MHD_OPTION_CONNECTION_LIMIT, static_cast<unsigned>(config_.connections), MHD_OPTION_PER_IP_CONNECTION_LIMIT,
      static_cast<unsigned>(config_.connections_per_address), MHD_OPTION_CONNECTION_TIMEOUT,
      static_cast<unsigned>(config_.idle_s), MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory,
      MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_NOTIFY_COMPLETED, &Glue::on_completed, this,
      MHD_OPTION_NOTIFY_CONNECTION, &Glue::on_connection, this, MHD_OPTION_UNESCAPE_CALLBACK, &Glue::no_unescape, this,
      MHD_OPTION_END);
  if (daemon_ == nullptr) {
    return failure(ResultCode::kInternal, "service: expected libmicrohttpd to start, found that it does not");
  }
  listener->release();
  return {};
}

bool HttpsServer::stop(int patience_ms) {
  if (daemon_ == nullptr) return true;
  stop_ = true;
  (void)eventfd_write(wake_.get(), 1);
  if (thread_.joinable()) thread_.join();
  if (!slow_.stop(patience_ms)) return false;
  connections_.for_each([](Connection& connection) {
    if (connection.stage == Stage::kWaits) MHD_resume_connection(connection.handle);
  });
  MHD_stop_daemon(daemon_);
  daemon_ = nullptr;
  return true;
}

void HttpsServer::run() {
  lower_priority("https");
  const int epoll_fd = MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_EPOLL_FD)->epoll_fd;
  std::array<pollfd, 2> looked_at{{{epoll_fd, POLLIN, 0}, {wake_.get(), POLLIN, 0}}};
  while (!stop_) {
    beats_.https();
    MHD_UNSIGNED_LONG_LONG patience = kLook_ms;
    if (MHD_get_timeout(daemon_, &patience) == MHD_NO || patience > kLook_ms) patience = kLook_ms;
    (void)poll(looked_at.data(), looked_at.size(), static_cast<int>(patience));
    MHD_run(daemon_);
    const std::int64_t now_us = monotonic_us();
    cut_overdue(now_us);
    refusals_.settle(now_us);
  }
}

// Only the socket is shut: libmicrohttpd then finds the connection ended and takes it down itself.
void HttpsServer::cut_overdue(std::int64_t now_us) {
  connections_.for_each([&](Connection& connection) {
    if (connection.stage == Stage::kWaits || now_us < connection.overdue_us) return;
    refusals_.write("service: " + address_text(connection.from) + " is cut off: a request took longer than " +
                        std::to_string(config_.request_s) + " s",
                    now_us);
    connection.overdue_us = kNever_us;
    connection.requests += 1;  // it is accounted for
    (void)shutdown(connection.fd, SHUT_RDWR);
  });
}

Connection* HttpsServer::opened(MHD_Connection* handle) {
  Connection* connection = connections_.take();
  if (connection == nullptr) return nullptr;
  Connections::next_request(*connection);
  connection->handle = handle;
  connection->fd = MHD_get_connection_info(handle, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
  connection->from = client_address(MHD_get_connection_info(handle, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr);
  connection->requests = 0;
  connection->overdue_us = monotonic_us() + config_.request_s * 1'000'000LL;
  return connection;
}

void HttpsServer::closed(Connection& connection) {
  if (connection.requests == 0) {
    refusals_.write("service: " + address_text(connection.from) + " went without a whole request", monotonic_us());
  }
  Connections::next_request(connection);
  connection.handle = nullptr;
}

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
  if (connection.overdue_us != kNever_us) {
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
