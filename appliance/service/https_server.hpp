// HttpsServer: libmicrohttpd, driven by one thread of ours, with every limit that keeps strangers from harming the
// cell: connections, requests a minute, time, bytes of head and body.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "service/api.hpp"
#include "service/certificate.hpp"
#include "service/connections.hpp"
#include "service/folder.hpp"
#include "service/gate.hpp"
#include "service/service_log.hpp"
#include "service/slow_lane.hpp"

struct MHD_Daemon;

namespace beltpick::service {

struct ServerConfig {
  std::string address = "127.0.0.1";
  std::uint16_t port = kDefaultServicePort;  // 0: any free one
  int connections = 32;
  int connections_per_address = 8;
  int requests_per_minute = 600;  // of one address
  int request_s = 30;             // from a request's first byte to its answer's last one
  int idle_s = 10;                // between two bytes, and between two requests
};

// What the threads tell the watchdog.
struct ServerBeats {
  std::function<void()> https, slow;
};

class HttpsServer {
 public:
  // Listens and serves. Errors: those of listen_on(), kInternal (libmicrohttpd does not start).
  static Result<std::unique_ptr<HttpsServer>> start(const ServerConfig& config, const Certificate& certificate,
                                                    TokenBook& tokens, Api& api, const LogLine& log,
                                                    const ServerBeats& beats);
  ~HttpsServer();
  HttpsServer(const HttpsServer&) = delete;
  HttpsServer& operator=(const HttpsServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }

  // False where a slow answer did not end in time: then nothing can be taken down, the process has to end.
  bool stop(int patience_ms);

 private:
  struct Glue;  // libmicrohttpd's callbacks

  HttpsServer(const ServerConfig& config, TokenBook& tokens, Api& api, const LogLine& log, const ServerBeats& beats);

  Result<void> open(const Certificate& certificate);
  void run();
  void cut_overdue(std::int64_t now_us);

  Connection* opened(MHD_Connection* handle);
  void closed(Connection& connection);
  void head_came(Connection& connection);
  void body_came(Connection& connection, const char* bytes, std::size_t count);
  // The whole request is there. False: the answer comes later.
  bool request_came(Connection& connection);
  ApiRequest request_of(const Connection& connection) const;
  void answer_slowly(Connection& connection, const ApiRequest& request);
  void finish(Connection& connection);
  void refuse(Connection& connection, const Error& error);
  void log_answer(const Connection& connection);

  ServerConfig config_;
  AddressBook addresses_;
  Gate gate_;
  Api& api_;
  LogLine log_;
  RefusalLog refusals_;
  ServerBeats beats_;
  Connections connections_;
  std::vector<char> upload_;         // the one buffer of uploads
  Connection* uploading_ = nullptr;  // whose it is
  std::size_t uploaded_ = 0;
  std::uint16_t port_ = 0;
  Descriptor wake_;
  MHD_Daemon* daemon_ = nullptr;
  std::atomic<bool> stop_{false};
  SlowLane slow_;
  std::thread thread_;
};

}  // namespace beltpick::service
