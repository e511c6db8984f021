#include "virtual_cell/world/plc_link.hpp"

#include <modbus/modbus.h>

#include <bit>
#include <cerrno>
#include <chrono>
#include <utility>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

using namespace std::chrono_literals;
constexpr auto kBeatEvery = 100ms;
constexpr auto kRetryEvery = 100ms;
constexpr unsigned kAnswerTimeout_s = 1;

Mat4 pose_at(const ApplianceRegisters& registers, std::uint16_t translation, std::uint16_t rotation) {
  Mat4 pose = Mat4::Identity();
  pose.topLeftCorner<3, 3>() = registers.rotation(rotation);
  pose.topRightCorner<3, 1>() = registers.vector(translation);
  return pose;
}

}  // namespace

double ApplianceRegisters::real(std::uint16_t address) const {
  return std::bit_cast<float>((static_cast<std::uint32_t>(word[address]) << 16U) | word[address + 1U]);
}

Vec3 ApplianceRegisters::vector(std::uint16_t address) const {
  return {real(address), real(static_cast<std::uint16_t>(address + 2)), real(static_cast<std::uint16_t>(address + 4))};
}

Mat3 ApplianceRegisters::rotation(std::uint16_t address) const {
  const Vec3 imaginary = vector(static_cast<std::uint16_t>(address + 2));
  return Eigen::Quaterniond(real(address), imaginary.x(), imaginary.y(), imaginary.z()).normalized().toRotationMatrix();
}

Offer offer_from(const ApplianceRegisters& registers) {
  Offer offer;
  offer.sequence = registers.at(register_address("pose_sequence_begin"));
  offer.whole = offer.sequence == registers.at(register_address("pose_sequence_end"));
  offer.part_number = registers.at(register_address("part_number"));
  offer.frame = static_cast<OfferFrame>(registers.at(register_address("pose_frame")));
  offer.part_pose = pose_at(registers, register_address("part_x_mm"), register_address("part_qw"));
  offer.gripper_pose = pose_at(registers, register_address("grasp_x_mm"), register_address("grasp_qw"));
  offer.opening_mm = registers.real(register_address("grasp_opening_mm"));
  return offer;
}

Result<std::unique_ptr<PlcLink>> PlcLink::connect(const std::string& host, int port, int patience_ms) {
  modbus_t* context = modbus_new_tcp(host.c_str(), port);
  if (context == nullptr) {
    return failure(ResultCode::kServiceUnreachable,
                   "virtual PLC: '%s' port %d is no Modbus address; expected e.g. 127.0.0.1", host.c_str(), port);
  }
  modbus_set_response_timeout(context, kAnswerTimeout_s, 0);
  const Stopwatch waiting;
  while (modbus_connect(context) != 0) {
    if (waiting.elapsed_ms() > patience_ms) {
      const int reason = errno;
      modbus_free(context);
      return failure(ResultCode::kServiceUnreachable,
                     "virtual PLC: no Modbus server at %s port %d: %s; is beltpickd running?", host.c_str(), port,
                     modbus_strerror(reason));
    }
    std::this_thread::sleep_for(kRetryEvery);
  }
  return std::unique_ptr<PlcLink>(new PlcLink(context, host, port));
}

PlcLink::PlcLink(_modbus* context, std::string host, int port)
    : context_(context), host_(std::move(host)), port_(port), heart_([this] { beat(); }) {}

PlcLink::~PlcLink() {
  stop_ = true;
  heart_.join();
  modbus_close(context_);
  modbus_free(context_);
}

Result<ApplianceRegisters> PlcLink::read() {
  const std::scoped_lock lock(mutex_);
  ApplianceRegisters registers;
  if (modbus_read_input_registers(context_, 0, kInputRegisters, registers.word.data()) == kInputRegisters)
    return registers;
  if (reconnect() &&
      modbus_read_input_registers(context_, 0, kInputRegisters, registers.word.data()) == kInputRegisters) {
    return registers;
  }
  return failure(ResultCode::kServiceUnreachable, "virtual PLC: the appliance at %s port %d no longer answers: %s",
                 host_.c_str(), port_, modbus_strerror(errno));
}

Result<void> PlcLink::write(std::uint16_t address, std::uint16_t value) {
  const std::scoped_lock lock(mutex_);
  if (modbus_write_register(context_, address, value) == 1) return {};
  if (reconnect() && modbus_write_register(context_, address, value) == 1) return {};
  return failure(ResultCode::kServiceUnreachable, "virtual PLC: cannot write register %u at %s port %d: %s",
                 unsigned{address}, host_.c_str(), port_, modbus_strerror(errno));
}

Result<void> PlcLink::write_status(std::uint16_t bits) { return write(register_address("plc_status"), bits); }

Result<void> PlcLink::write_command(PlcCommand command, std::uint16_t argument) {
  if (command != PlcCommand::kNone) {
    if (auto done = write(register_address("command_argument"), argument); !done) return done;
  }
  return write(register_address("command"), static_cast<std::uint16_t>(command));
}

bool PlcLink::reconnect() {
  modbus_close(context_);
  return modbus_connect(context_) == 0;
}

void PlcLink::beat() {
  std::uint16_t count = 0;
  while (!stop_) {
    // A beat that cannot be written is noticed by the next read of the program.
    if (!silent_) (void)write(register_address("plc_heartbeat"), ++count);
    std::this_thread::sleep_for(kBeatEvery);
  }
}

}  // namespace beltpick::virtual_cell
