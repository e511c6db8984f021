#include "plc/modbus_server.hpp"

#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <span>

#include "base/clock.hpp"

namespace beltpick::plc {

// libmodbus' context and the register memory it answers from.
struct ModbusServer::Modbus {
  modbus_t* context = modbus_new_tcp(nullptr, 0);
  modbus_mapping_t* mapping = modbus_mapping_new(0, 0, kHoldingRegisters, kInputRegisters);

  Modbus() {
    if (context == nullptr || mapping == nullptr) throw std::bad_alloc();
    modbus_set_response_timeout(context, 0, 1000);  // should it ever wait, then a millisecond
  }
  ~Modbus() {
    modbus_mapping_free(mapping);
    modbus_free(context);
  }
  Modbus(const Modbus&) = delete;
  Modbus& operator=(const Modbus&) = delete;
};

ModbusServer::ModbusServer(const ModbusServerConfig& config, PlcExchange& exchange)
    : config_(config), exchange_(exchange), modbus_(std::make_unique<Modbus>()) {
  config_.max_clients = std::clamp(config_.max_clients, 1, kMaxClients);
}

ModbusServer::~ModbusServer() {
  for (Client& client : clients_) drop(client);
  if (listener_ >= 0) close(listener_);
}

Result<std::unique_ptr<ModbusServer>> ModbusServer::open(const ModbusServerConfig& config, PlcExchange& exchange) {
  std::unique_ptr<ModbusServer> server(new ModbusServer(config, exchange));
  if (const auto listening = server->listen(); !listening) return std::unexpected(listening.error());
  return server;
}

Result<void> ModbusServer::listen() {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(config_.port);
  if (inet_pton(AF_INET, config_.address.c_str(), &at.sin_addr) != 1) {
    return failure(ResultCode::kValueOutOfRange, "modbus address '%s': expected an IPv4 address such as 0.0.0.0",
                   config_.address.c_str());
  }
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (listener_ < 0 || bind(listener_, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 ||
      ::listen(listener_, kMaxClients) != 0) {
    return failure(ResultCode::kValueOutOfRange,
                   "modbus port %u on %s cannot be opened: %s; choose another port, or allow ports below 1024",
                   static_cast<unsigned>(config_.port), config_.address.c_str(), std::strerror(errno));
  }
  socklen_t size = sizeof at;
  getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size);
  port_ = ntohs(at.sin_port);
  return {};
}

void ModbusServer::poll(int timeout_ms) {
  std::array<pollfd, kMaxClients + 1> waiting{};
  std::array<Client*, kMaxClients + 1> owner{};
  nfds_t count = 0;
  waiting[count++] = {listener_, POLLIN, 0};
  for (Client& client : clients_) {
    if (client.socket < 0) continue;
    owner[count] = &client;
    waiting[count++] = {client.socket, POLLIN, 0};
  }
  const int ready = ::poll(waiting.data(), count, timeout_ms);
  const std::int64_t now_us = monotonic_us();
  for (nfds_t i = 1; ready > 0 && i < count; ++i) {
    if (waiting[i].revents != 0) receive(*owner[i], now_us);
  }
  if (ready > 0 && waiting[0].revents != 0) accept_clients(now_us);
  for (Client& client : clients_) {
    if (client.socket >= 0 && client.received > 0 && now_us - client.half_since_us > config_.half_request_us)
      drop(client);
  }
}

void ModbusServer::accept_clients(std::int64_t now_us) {
  for (;;) {
    const int socket = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket < 0) return;
    Client* place = place_for_new_client(now_us);
    if (place == nullptr) {
      close(socket);
      continue;
    }
    const int on = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    place->socket = socket;
    place->received = 0;
    place->last_us = now_us;
    ++client_count_;
  }
}

// A free place, else that of the client silent for longest, if that is long enough: half-open connections of a PLC that
// lost power must not lock it out.
ModbusServer::Client* ModbusServer::place_for_new_client(std::int64_t now_us) {
  const auto end = clients_.begin() + config_.max_clients;
  const auto free = std::find_if(clients_.begin(), end, [](const Client& c) { return c.socket < 0; });
  if (free != end) return &*free;
  const auto idlest =
      std::min_element(clients_.begin(), end, [](const Client& a, const Client& b) { return a.last_us < b.last_us; });
  if (now_us - idlest->last_us < config_.idle_us) return nullptr;
  drop(*idlest);
  return &*idlest;
}

void ModbusServer::receive(Client& client, std::int64_t now_us) {
  const bool was_empty = client.received == 0;
  const ssize_t got =
      recv(client.socket, client.buffer.data() + client.received, client.buffer.size() - client.received, 0);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (got <= 0) return drop(client);
  client.received += static_cast<std::size_t>(got);
  if (was_empty) client.half_since_us = now_us;
  if (!serve_frames(client, now_us)) drop(client);
}

bool ModbusServer::serve_frames(Client& client, std::int64_t now_us) {
  for (;;) {
    const Frame frame = find_frame({client.buffer.data(), client.received});
    if (frame.state == FrameState::kBroken) return false;
    if (frame.state == FrameState::kIncomplete) return true;
    if (!answer(client, frame.bytes, now_us)) return false;
    client.received -= frame.bytes;
    std::memmove(client.buffer.data(), client.buffer.data() + frame.bytes, client.received);
    client.last_us = client.half_since_us = now_us;
  }
}

// False when the client does not take its answer.
bool ModbusServer::answer(const Client& client, std::size_t bytes, std::int64_t now_us) {
  const std::span<const std::uint8_t> request(client.buffer.data(), bytes);
  const RequestCheck check = check_request(request, kHoldingRegisters, kInputRegisters);
  if (check.exception != ModbusException::kNone) {
    const std::array<std::uint8_t, 9> refusal{request[0],
                                              request[1],
                                              0,
                                              0,
                                              0,
                                              3,
                                              request[6],
                                              static_cast<std::uint8_t>(request[7] | 0x80U),
                                              static_cast<std::uint8_t>(check.exception)};
    return send(client.socket, refusal.data(), refusal.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(refusal.size());
  }
  modbus_mapping_t& mapping = *modbus_->mapping;
  exchange_.copy_inputs(InputImage(mapping.tab_input_registers, kInputRegisters));
  modbus_set_socket(modbus_->context, client.socket);
  const int sent = modbus_reply(modbus_->context, request.data(), static_cast<int>(request.size()), &mapping);
  if (check.writes) {
    exchange_.holding_written(
        std::span<const std::uint16_t, kHoldingRegisters>(mapping.tab_registers, kHoldingRegisters), now_us);
  }
  return sent > 0;
}

void ModbusServer::drop(Client& client) {
  if (client.socket < 0) return;
  close(client.socket);
  client.socket = -1;
  client.received = 0;
  --client_count_;
}

}  // namespace beltpick::plc
