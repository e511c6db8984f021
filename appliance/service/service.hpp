// Service: the HTTPS API as the appliance starts and stops it: state folder, certificate, tokens, server.
#pragma once

#include <filesystem>
#include <memory>

#include "service/https_server.hpp"

namespace beltpick::service {

class Service {
 public:
  // Opens what `state` holds, making what is missing, and serves; says in the log where, and with which certificate.
  // `store` and `cell` outlive it. Errors: those of open_certificate(), TokenBook::open() and HttpsServer::start().
  static Result<std::unique_ptr<Service>> start(const std::filesystem::path& state, const ServerConfig& config,
                                                Store& store, CellSide& cell, const LogLine& log,
                                                const ServerBeats& beats);

  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  // False where a slow answer did not end in time: then nothing can be taken down, the process has to end.
  bool stop(int patience_ms) { return server_->stop(patience_ms); }

 private:
  Service(TokenBook tokens, Store& store, CellSide& cell);

  TokenBook tokens_;
  Api api_;
  std::unique_ptr<HttpsServer> server_;
};

// For `beltpickd --new-one-time-token`: writes one into the state folder. Returns its path.
// Errors: kFileNotWritten.
Result<std::filesystem::path> new_one_time_token(const std::filesystem::path& state);

}  // namespace beltpick::service
