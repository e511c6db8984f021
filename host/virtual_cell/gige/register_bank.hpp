// RegisterBank: the camera's memory as GVCP sees it: registers, then the XML text. Thread safe.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "virtual_cell/gige/wire.hpp"

namespace beltpick::virtual_cell::gige {

struct CameraIdentity {
  std::string serial = "BP0001";  // up to 15 characters
  int width = 1280;
  int height = 960;
};

class RegisterBank {
 public:
  // `ip` in host byte order.
  RegisterBank(CameraIdentity identity, std::uint32_t ip);

  // Everything as it was at construction.
  void power_cycle();

  // Address and size must be multiples of four and lie inside the space.
  GevStatus read(std::uint32_t at, std::span<std::uint8_t> out) const;
  // Read-only registers answer kWriteProtect.
  GevStatus write(std::uint32_t at, std::span<const std::uint8_t> bytes);

  [[nodiscard]] std::uint32_t get(std::uint32_t at) const;
  void set(std::uint32_t at, std::uint32_t value);
  [[nodiscard]] double get_double(std::uint32_t at) const;
  void set_double(std::uint32_t at, double value);

 private:
  void set_text(std::uint32_t at, const std::string& text);
  void set_bootstrap();
  void set_features();

  const CameraIdentity identity_;
  const std::uint32_t ip_;
  mutable std::mutex mutex_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace beltpick::virtual_cell::gige
