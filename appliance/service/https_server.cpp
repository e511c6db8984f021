#include "service/https_server.hpp"

#include <microhttpd.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <limits>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "service/listen_socket.hpp"
#include "service/mhd_response.hpp"

namespace beltpick::service {
namespace {

using Stage = Connection::Stage;

constexpr const char* kPriorities = "SECURE128:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:%SERVER_PRECEDENCE";
constexpr std::size_t kConnectionMemory = 16384;  // head of a request, and what is read of its body
constexpr int kLook_ms = 200;                     // how often deadlines are looked at

std::size_t largest_item() {
  return std::max_element(kItemKinds.begin(), kItemKinds.end(),
                          [](const auto& a, const auto& b) { return a.max_bytes < b.max_bytes; })
      ->max_bytes;
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
  sigset_t broken_pipe;  // a client that is gone must not end the process
  sigemptyset(&broken_pipe);
  sigaddset(&broken_pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &broken_pipe, nullptr);
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
    connection.overdue_us = Connection::kNever_us;
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

}  // namespace beltpick::service
