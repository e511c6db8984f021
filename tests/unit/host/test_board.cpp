// The board in real time: what it does is checked in its own clock, so that a loaded machine cannot fail it.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

#include "host/board.hpp"

using namespace beltpick;
using host::Pin;

namespace {

// A board with a camera that mirrors pulse and strobe, and the host's end of its serial line.
class Cell {
 public:
  explicit Cell(bool belt_stopped = true)
      : board({.link = {},
               .belt_stopped = belt_stopped,
               .emergency_stop = false,
               .on_edge = [this](const host::PinEdge& e) { on_edge(e); }}),
        fd_(::open(board.tty().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    REQUIRE(fd_ >= 0);
  }
  ~Cell() { ::close(fd_); }

  template <class Payload>
  void send(protocol::Type type, const Payload& payload) {
    std::uint8_t wire[protocol::kMaxFrame];
    const std::size_t size = protocol::encode(type, sequence_++, payload, wire, sizeof wire);
    REQUIRE(::write(fd_, wire, size) == static_cast<ssize_t>(size));
  }

  // Waits for a message of that type, reading over others; false when none comes.
  template <class Payload>
  bool await(protocol::Type type, Payload& payload, int patience_ms = 5000) {
    pollfd wait{fd_, POLLIN, 0};
    while (::poll(&wait, 1, patience_ms) > 0) {
      std::uint8_t byte = 0;
      if (::read(fd_, &byte, 1) != 1) return false;
      if (decoder_.push(byte) != protocol::FrameDecoder::Outcome::kMessage) continue;
      protocol::Header header;
      protocol::decode_header(decoder_.message(), decoder_.size(), header);
      if (header.type == type) return protocol::decode_payload(decoder_.message(), decoder_.size(), payload);
    }
    return false;
  }

  protocol::Refusal run(std::uint16_t arm_id, std::uint16_t frames) {
    protocol::Arm arm;
    arm.arm_id = arm_id;
    arm.host_silence_ms = 5000;
    arm.strobe_tolerance_us = 500;
    arm.group_count = 1;
    arm.groups[0] = {frames, 200, 1000, 3000, 1000};
    protocol::Reply reply;
    send(protocol::Type::kArm, arm);
    if (!await(protocol::Type::kReply, reply) || reply.refusal != protocol::Refusal::kNone) return reply.refusal;
    send(protocol::Type::kStart, protocol::Start{arm_id});
    await(protocol::Type::kReply, reply);
    return reply.refusal;
  }

  std::vector<host::PinEdge> edges(Pin pin) {
    const std::lock_guard lock(mutex_);
    std::vector<host::PinEdge> found;
    for (const auto& edge : edges_) {
      if (edge.pin == pin) found.push_back(edge);
    }
    return found;
  }

  std::mutex mutex_;
  std::vector<host::PinEdge> edges_;
  host::Board board;

 private:
  void on_edge(const host::PinEdge& edge) {
    {
      const std::lock_guard lock(mutex_);
      edges_.push_back(edge);
    }
    if (edge.pin == Pin::kCameraTrigger) board.set_strobe(edge.level);
  }

  int fd_;
  std::uint8_t sequence_ = 0;
  protocol::FrameDecoder decoder_;
};

}  // namespace

TEST_CASE("a sequence runs over the serial line with exact edges in the board's clock", "[host]") {
  Cell cell;
  REQUIRE(cell.run(1, 22) == protocol::Refusal::kNone);
  protocol::FrameEvent frame;
  for (std::uint16_t i = 0; i < 22; ++i) {
    REQUIRE(cell.await(protocol::Type::kFrameEvent, frame));
    CHECK(frame.frame == i);
    CHECK(frame.pulse_ticks == core::ticks_of(3000U * i + 200U));
    CHECK(frame.strobe_ticks - frame.pulse_ticks < core::ticks_of(500));
  }
  protocol::DoneEvent done;
  REQUIRE(cell.await(protocol::Type::kDoneEvent, done));
  CHECK(done.duration_ticks == core::ticks_of(22 * 3000));
  const auto pulses = cell.edges(Pin::kCameraTrigger);
  REQUIRE(pulses.size() == 44);
  for (std::size_t i = 0; i < pulses.size(); i += 2) {
    CHECK(pulses[i].level);
    CHECK(pulses[i + 1].board_us - pulses[i].board_us == 1000);
    CHECK(pulses[i + 1].at_ns - pulses[i].at_ns >= 900'000);
  }
  CHECK(cell.edges(Pin::kProjectorAdvance).size() == 44);
  CHECK(cell.edges(Pin::kBusy).size() == 2);
}

TEST_CASE("a strobe that is cut off is missed, and the board recovers", "[host]") {
  Cell cell;
  cell.board.drop_strobes(1);
  REQUIRE(cell.run(1, 5) == protocol::Refusal::kNone);
  protocol::FaultEvent fault;
  REQUIRE(cell.await(protocol::Type::kFaultEvent, fault));
  CHECK(fault.fault == protocol::Fault::kStrobeMissing);
  CHECK(fault.frame == 0);
  protocol::Reply reply;
  cell.send(protocol::Type::kClear, protocol::Empty());
  REQUIRE(cell.await(protocol::Type::kReply, reply));
  REQUIRE(cell.run(2, 5) == protocol::Refusal::kNone);
  protocol::DoneEvent done;
  CHECK(cell.await(protocol::Type::kDoneEvent, done));
}

TEST_CASE("a dropped camera pulse does not reach the camera, a dropped advance not the projector", "[host]") {
  Cell cell;
  cell.board.drop_projector_advances(2);
  REQUIRE(cell.run(1, 5) == protocol::Refusal::kNone);
  protocol::DoneEvent done;
  REQUIRE(cell.await(protocol::Type::kDoneEvent, done));
  CHECK(cell.edges(Pin::kProjectorAdvance).size() == 6);
  CHECK(cell.edges(Pin::kCameraTrigger).size() == 10);
  cell.board.drop_camera_pulses(1);
  REQUIRE(cell.run(2, 5) == protocol::Refusal::kNone);
  protocol::FaultEvent fault;
  REQUIRE(cell.await(protocol::Type::kFaultEvent, fault));
  CHECK(fault.fault == protocol::Fault::kStrobeMissing);
  CHECK(cell.edges(Pin::kCameraTrigger).size() == 10);
}

TEST_CASE("input pins are told and stop a sequence", "[host]") {
  Cell cell(false);
  CHECK(cell.run(1, 5) == protocol::Refusal::kBeltNotStopped);
  cell.board.set_belt_stopped(true);
  protocol::InputsEvent inputs;
  REQUIRE(cell.await(protocol::Type::kInputsEvent, inputs));
  CHECK(inputs.inputs == protocol::kInputBeltStopped);
  REQUIRE(cell.run(2, 500) == protocol::Refusal::kNone);
  cell.board.set_belt_stopped(false);
  protocol::FaultEvent fault;
  REQUIRE(cell.await(protocol::Type::kFaultEvent, fault));
  CHECK(fault.fault == protocol::Fault::kBeltMoved);
  REQUIRE(cell.await(protocol::Type::kInputsEvent, inputs));
  CHECK(inputs.inputs == 0);
  cell.board.set_emergency_stop(true);
  REQUIRE(cell.await(protocol::Type::kInputsEvent, inputs));
  CHECK((inputs.inputs & protocol::kInputEmergencyStop) != 0);
}

TEST_CASE("a muted line neither hears nor speaks", "[host]") {
  Cell cell;
  cell.board.mute(true);
  protocol::StatusReport report;
  cell.send(protocol::Type::kStatus, protocol::Empty());
  CHECK_FALSE(cell.await(protocol::Type::kStatusReport, report, 200));
  cell.board.mute(false);
  cell.send(protocol::Type::kStatus, protocol::Empty());
  CHECK(cell.await(protocol::Type::kStatusReport, report));
}

TEST_CASE("the link names the tty while the board lives", "[host]") {
  const auto link = std::filesystem::temp_directory_path() / ("beltpick-board-" + std::to_string(::getpid()));
  {
    host::BoardOptions options;
    options.link = link;
    const host::Board board(options);
    CHECK(std::filesystem::read_symlink(link) == board.tty());
  }
  CHECK_FALSE(std::filesystem::exists(std::filesystem::symlink_status(link)));
}

TEST_CASE("a board that hangs is reset by its watchdog, says so once, and works again") {
  Cell cell;
  cell.board.hang();
  protocol::FaultEvent fault;
  REQUIRE(cell.await(protocol::Type::kFaultEvent, fault));
  CHECK(fault.fault == protocol::Fault::kWatchdogReset);
  protocol::Reply reply;
  cell.send(protocol::Type::kClear, protocol::Empty());
  REQUIRE(cell.await(protocol::Type::kReply, reply));
  CHECK(reply.refusal == protocol::Refusal::kNone);
  CHECK(cell.run(1, 3) == protocol::Refusal::kNone);
}

TEST_CASE("noise flips and drops its share of the bytes, and no more") {
  host::LineNoise noise(7);
  std::vector<std::uint8_t> bytes(10'000, 0x55);
  CHECK(noise.pass(bytes.data(), bytes.size()) == bytes.size());
  noise.set_share(0.02);
  const std::size_t left = noise.pass(bytes.data(), bytes.size());
  bytes.resize(left);
  const auto flipped = static_cast<std::size_t>(
      std::count_if(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte != 0x55; }));
  const std::size_t dropped = 10'000 - left;
  CHECK(dropped > 60);
  CHECK(dropped < 140);
  CHECK(flipped > 60);
  CHECK(flipped < 140);
}
