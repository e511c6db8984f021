#include "service/service.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cstring>

#include "contract/result_codes.hpp"
#include "service/listen_socket.hpp"

namespace beltpick::service {
namespace {

Result<Folder> open_state(const std::filesystem::path& state) {
  auto folder = Folder::make(state);
  if (folder) return std::move(*folder);
  return failure(ResultCode::kFileNotWritten, "%s: expected a folder for the service's state, found: %s; correct %s",
                 state.c_str(), std::strerror(folder.error()), "service.state");
}

}  // namespace

Service::Service(TokenBook tokens, Store& store, CellSide& cell)
    : tokens_(std::move(tokens)), api_(store, cell, tokens_) {}

Result<std::unique_ptr<Service>> Service::start(const std::filesystem::path& state, const ServerConfig& config,
                                                Store& store, CellSide& cell, const LogLine& log,
                                                const ServerBeats& beats) {
  auto folder = open_state(state);
  if (!folder) return std::unexpected(folder.error());
  std::vector<std::string> notes;
  const auto certificate = open_certificate(*folder, notes);
  if (!certificate) return std::unexpected(certificate.error());
  auto tokens = TokenBook::open(std::move(*folder), notes);
  if (!tokens) return std::unexpected(tokens.error());
  for (const std::string& note : notes) log(false, "service: " + note + " (" + state.string() + ")");

  std::unique_ptr<Service> service(new Service(std::move(*tokens), store, cell));
  auto server = HttpsServer::start(config, *certificate, service->tokens_, service->api_, log, beats);
  if (!server) return std::unexpected(server.error());
  service->server_ = std::move(*server);
  log(false, "service: https://" + url_host(config.address) + ":" + std::to_string(service->port()) + ", key " +
                 certificate->fingerprint);
  return service;
}

Result<std::filesystem::path> new_one_time_token(const std::filesystem::path& state) {
  const auto folder = open_state(state);
  if (!folder) return std::unexpected(folder.error());
  if (const auto written = write_one_time_token(*folder); !written) return std::unexpected(written.error());
  const std::filesystem::path path = state / kOneTimeTokenFile;
  struct stat owner {};
  // Written by root, it is for the service's user to read.
  if (geteuid() == 0 && stat(state.c_str(), &owner) == 0) (void)!chown(path.c_str(), owner.st_uid, owner.st_gid);
  return path;
}

}  // namespace beltpick::service
