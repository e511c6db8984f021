// ControlChannel: the camera's GVCP side: discovery, registers and memory, resend requests, control privilege with its
// heartbeat, pending acknowledges. One thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "base/result.hpp"
#include "virtual_cell/gige/register_bank.hpp"
#include "virtual_cell/gige/wire.hpp"

struct sockaddr_in;

namespace beltpick::virtual_cell::gige {

// What the camera does about what the client says; called in the control thread.
struct ControlEvents {
  std::function<void(std::uint32_t at, std::uint32_t value)> written;
  std::function<void(std::uint16_t block_id, std::uint32_t first, std::uint32_t last)> resend;
  std::function<void()> control_lost;  // released, or the client's heartbeat stopped
};

class ControlChannel {
 public:
  // Listens on `ip`, UDP port 3956. kServiceUnreachable where that is taken.
  static Result<std::unique_ptr<ControlChannel>> open(std::uint32_t ip, RegisterBank& bank, ControlEvents events);
  ~ControlChannel();
  ControlChannel(const ControlChannel&) = delete;
  ControlChannel& operator=(const ControlChannel&) = delete;

  // A silent channel takes requests and answers none, like a camera without power; whoever had control loses it.
  void set_silent(bool silent) { silent_ = silent; }
  // Register writes are answered after this time, announced by a pending acknowledge; 0: at once.
  void set_write_delay_ms(int delay_ms) { write_delay_ms_ = delay_ms; }

 private:
  struct Client {
    std::uint32_t ip = 0;  // network byte order, as is the port; 0: nobody
    std::uint16_t port = 0;
    std::int64_t heard_us = 0;
  };
  struct Request {
    GvcpMessage message{};
    std::uint16_t id = 0;
    bool wants_answer = false;
    std::span<const std::uint8_t> data;
  };

  ControlChannel(int socket, RegisterBank& bank, ControlEvents events);

  void run();
  void receive();
  void check_heartbeat();
  void release_control();
  void handle(const Request& request, const sockaddr_in& from);
  GevStatus read_registers(const Request& request, std::vector<std::uint8_t>& answer);
  GevStatus read_memory(const Request& request, std::vector<std::uint8_t>& answer);
  GevStatus write_registers(const Request& request, const sockaddr_in& from, std::vector<std::uint8_t>& answer);
  GevStatus write_memory(const Request& request, const sockaddr_in& from, std::vector<std::uint8_t>& answer);
  GevStatus write(std::uint32_t at, std::span<const std::uint8_t> bytes, const sockaddr_in& from);
  void take_resend(const Request& request);
  [[nodiscard]] bool is_controller(const sockaddr_in& from) const;
  GevStatus write_privilege(std::uint32_t value, const sockaddr_in& from);
  void announce_pending(std::uint16_t id, const sockaddr_in& from);
  void answer(const Request& request, GevStatus status, std::span<const std::uint8_t> data, const sockaddr_in& from);

  int socket_;
  RegisterBank& bank_;
  ControlEvents events_;
  Client controller_;
  std::atomic<bool> silent_{false};
  std::atomic<int> write_delay_ms_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace beltpick::virtual_cell::gige
