// PlcLink: the virtual PLC's side of the Modbus connection: holding registers written, input registers read, a
// heartbeat that beats by itself in a thread of its own so that a PLC busy elsewhere still counts as alive.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "base/pose.hpp"
#include "base/result.hpp"
#include "contract/registers.hpp"

struct _modbus;

namespace beltpick::virtual_cell {

// The input registers as they stood at one read.
struct ApplianceRegisters {
  std::array<std::uint16_t, kInputRegisters> word{};

  [[nodiscard]] std::uint16_t at(std::uint16_t address) const { return word[address]; }
  [[nodiscard]] CellState state() const { return static_cast<CellState>(at(register_address("state"))); }
  [[nodiscard]] bool has(ApplianceStatusBit bit) const { return (at(register_address("status")) & bit) != 0; }
  // A float32, high word first.
  [[nodiscard]] double real(std::uint16_t address) const;
  [[nodiscard]] Vec3 vector(std::uint16_t address) const;
  [[nodiscard]] Mat3 rotation(std::uint16_t address) const;
};

// Frame in which an offer's poses stand: values of register pose_frame.
enum class OfferFrame : std::uint16_t { kCamera = 1, kBelt = 2, kRobot = 3 };

struct Offer {
  std::uint16_t sequence = 0;
  std::uint16_t part_number = 0;
  OfferFrame frame = OfferFrame::kCamera;
  Mat4 part_pose = Mat4::Identity();     // part -> frame, mm
  Mat4 gripper_pose = Mat4::Identity();  // gripper -> frame, mm
  double opening_mm = 0.0;
  bool whole = false;  // begin and end numbers of the block agree
};

Offer offer_from(const ApplianceRegisters& registers);

class PlcLink {
 public:
  // Connects, retrying for `patience_ms`. kServiceUnreachable when nobody answers.
  static Result<std::unique_ptr<PlcLink>> connect(const std::string& host, int port, int patience_ms);
  ~PlcLink();
  PlcLink(const PlcLink&) = delete;
  PlcLink& operator=(const PlcLink&) = delete;

  // Reads all input registers in one request. kServiceUnreachable when the connection is gone and does not come back.
  Result<ApplianceRegisters> read();
  // Bits of register plc_status.
  Result<void> write_status(std::uint16_t bits);
  // Argument first, then the command, as the register table demands.
  Result<void> write_command(PlcCommand command, std::uint16_t argument);
  // A silent PLC's heartbeat stands still.
  void set_silent(bool silent) { silent_ = silent; }

 private:
  PlcLink(_modbus* context, std::string host, int port);

  Result<void> write(std::uint16_t address, std::uint16_t value);
  bool reconnect();
  void beat();

  _modbus* context_;
  std::string host_;
  int port_;
  std::mutex mutex_;
  std::atomic<bool> silent_{false};
  std::atomic<bool> stop_{false};
  std::thread heart_;
};

}  // namespace beltpick::virtual_cell
