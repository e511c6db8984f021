// Line: the trigger box's serial line, ours alone for as long as it lives: a beltpickd that wants it waits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "base/result.hpp"

namespace beltpick::flash {

class Line {
 public:
  // Errors: kTriggerLost where it cannot be opened, kDeviceInUse with the name of the program that has it.
  static Result<Line> open(const std::string& port);
  Line(Line&& other) noexcept;
  Line& operator=(Line&&) = delete;
  ~Line();

  [[nodiscard]] const std::string& port() const { return port_; }

  // Bytes that nobody takes are lost, as on a wire.
  void send(const std::uint8_t* bytes, std::size_t count) const;
  // The next byte, within `timeout_ms`.
  [[nodiscard]] std::optional<std::uint8_t> receive(int timeout_ms) const;
  // Lets DTR fall and rise: resets a board whose reset pin hangs on it, as an Arduino's does.
  void reset_board() const;
  // Forgets what has come so far.
  void forget() const;

 private:
  Line(int fd, std::string port);

  int fd_;
  std::string port_;
};

}  // namespace beltpick::flash
