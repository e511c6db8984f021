// The Modbus TCP server: own non-blocking framing in front of libmodbus, one thread, a fixed number of clients.
// A client that sends rubbish, half a request or nothing delays nobody.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "base/result.hpp"
#include "plc/modbus_request.hpp"
#include "plc/plc_exchange.hpp"

namespace beltpick::plc {

struct ModbusServerConfig {
  std::string address = "0.0.0.0";           // IPv4 to listen on
  std::uint16_t port = 502;                  // 0: any free one, see ModbusServer::port()
  int max_clients = 8;                       // at most ModbusServer::kMaxClients
  std::int64_t half_request_us = 2'000'000;  // a client that began a request must end it within
  std::int64_t idle_us = 10'000'000;         // one silent for so long gives way when a new client needs its place
};

class ModbusServer {
 public:
  static constexpr int kMaxClients = 32;

  // Opens the port. Fails with VALUE_OUT_OF_RANGE when it cannot be had. Everything is allocated here.
  static Result<std::unique_ptr<ModbusServer>> open(const ModbusServerConfig& config, PlcExchange& exchange);
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  // Serves what has arrived; waits at most `timeout_ms` for something. Never blocks on a client, never allocates.
  void poll(int timeout_ms);

  [[nodiscard]] std::uint16_t port() const { return port_; }
  // From any thread.
  [[nodiscard]] int clients() const { return client_count_; }

 private:
  struct Client {
    int socket = -1;
    std::size_t received = 0;
    std::int64_t last_us = 0;        // last whole request, or the connection
    std::int64_t half_since_us = 0;  // when the unfinished request began
    std::array<std::uint8_t, kMaxAduBytes> buffer{};
  };
  struct Modbus;

  ModbusServer(const ModbusServerConfig& config, PlcExchange& exchange);
  Result<void> listen();
  void accept_clients(std::int64_t now_us);
  Client* place_for_new_client(std::int64_t now_us);
  void receive(Client& client, std::int64_t now_us);
  bool serve_frames(Client& client, std::int64_t now_us);
  bool answer(const Client& client, std::size_t bytes, std::int64_t now_us);
  void drop(Client& client);

  ModbusServerConfig config_;
  PlcExchange& exchange_;
  std::unique_ptr<Modbus> modbus_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::array<Client, kMaxClients> clients_{};
  std::atomic<int> client_count_{0};
};

}  // namespace beltpick::plc
