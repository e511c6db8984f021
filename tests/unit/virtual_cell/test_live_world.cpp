// The live world over its real wires: ARM and START on the serial line, frames through Aravis.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <optional>
#include <vector>

#include "aravis_client.hpp"
#include "contract/sequences.hpp"
#include "protocol/messages.hpp"
#include "virtual_cell/render/scene.hpp"
#include "virtual_cell/world/emulator_files.hpp"
#include "virtual_cell/world/live_world.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

// Of this run's own: two runs at once do not share a camera.
const std::string kAddress =
    "127.1." + std::to_string(::getpid() / 250 % 250) + "." + std::to_string(1 + ::getpid() % 250);

// The appliance's end of the serial line.
class Serial {
 public:
  explicit Serial(const std::string& tty) : fd_(::open(tty.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    REQUIRE(fd_ >= 0);
  }
  ~Serial() { ::close(fd_); }

  template <class Payload>
  void send(protocol::Type type, const Payload& payload) {
    std::uint8_t wire[protocol::kMaxFrame];
    const std::size_t size = protocol::encode(type, 0, payload, wire, sizeof wire);
    REQUIRE(::write(fd_, wire, size) == static_cast<ssize_t>(size));
  }

  template <class Payload>
  bool await(protocol::Type type, Payload& payload) {
    pollfd wait{fd_, POLLIN, 0};
    while (::poll(&wait, 1, 5000) > 0) {
      std::uint8_t byte = 0;
      if (::read(fd_, &byte, 1) != 1) return false;
      if (decoder_.push(byte) != protocol::FrameDecoder::Outcome::kMessage) continue;
      protocol::Header header;
      protocol::decode_header(decoder_.message(), decoder_.size(), header);
      if (header.type == type) return protocol::decode_payload(decoder_.message(), decoder_.size(), payload);
    }
    return false;
  }

 private:
  int fd_;
  protocol::FrameDecoder decoder_;
};

LiveWorldSettings small_cell() {
  RigOptions rig;
  rig.camera_width = 320;
  rig.camera_height = 240;
  rig.projector_width = 228;
  rig.projector_height = 284;
  LiveWorldSettings settings;
  settings.rig = *make_rig(rig);
  settings.parts.push_back(*builtin_part("knuckle"));
  settings.views = SceneMaker(settings.parts, settings.rig).make_belt(3, 5);
  settings.sequence =
      *make_sequence(SequenceName::kRobust, {228, 284, ProjectorLayout::kSquare}, SequenceAxes::kColumn);
  settings.camera_address = kAddress;
  settings.speed = 20.0;
  return settings;
}

protocol::Arm sequence(std::uint16_t arm_id, int frames, std::uint32_t tolerance_us = 2000) {
  protocol::Arm arm;
  arm.arm_id = arm_id;
  arm.host_silence_ms = 60'000;
  arm.strobe_tolerance_us = tolerance_us;
  arm.group_count = 1;
  arm.groups[0] = {static_cast<std::uint16_t>(frames), 1000, 8000, 25'000, 12'000};
  return arm;
}

// The cell with the firmware's ELF in an emulated microcontroller; nothing where there is no emulator.
std::optional<LiveWorldSettings> emulated_cell() {
  const auto board = find_emulator(BELTPICK_BIN_DIR, "");
  if (!board) {
    WARN("skipped: " << board.error().detail);
    return std::nullopt;
  }
  LiveWorldSettings settings = small_cell();
  settings.board = *board;
  settings.trigger_link = std::filesystem::temp_directory_path() / ("test_live_world." + std::to_string(::getpid()));
  return settings;
}

std::vector<double> capture_means(test::AravisClient& client, Serial& serial, std::uint16_t arm_id, int frames) {
  protocol::Reply reply;
  serial.send(protocol::Type::kArm, sequence(arm_id, frames));
  REQUIRE(serial.await(protocol::Type::kReply, reply));
  REQUIRE(reply.refusal == protocol::Refusal::kNone);
  serial.send(protocol::Type::kStart, protocol::Start{arm_id});
  protocol::DoneEvent done;
  REQUIRE(serial.await(protocol::Type::kDoneEvent, done));
  CHECK(done.frames == frames);
  std::vector<double> means;
  for (int i = 0; i < frames; ++i) {
    ArvBuffer* buffer = arv_stream_timeout_pop_buffer(client.stream, 3'000'000);
    if (buffer == nullptr) break;
    CHECK(arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS);
    std::size_t size = 0;
    const auto* pixels = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
    means.push_back(std::accumulate(pixels, pixels + size, 0.0) / static_cast<double>(size));
    arv_stream_push_buffer(client.stream, buffer);
  }
  return means;
}

}  // namespace

TEST_CASE("a started sequence exposes every pattern once, in order, twice in a row") {
  auto world = LiveWorld::start(small_cell());
  if (!world) FAIL(world.error().detail);
  REQUIRE((*world)->bring_next_parts());
  CHECK((*world)->parts_in_view() == 3);
  test::AravisClient client(kAddress.c_str());
  Serial serial((*world)->trigger_tty());
  const int frames = static_cast<int>(small_cell().sequence.frames.size());
  const std::vector<double> first = capture_means(client, serial, 1, frames);
  const std::vector<double> second = capture_means(client, serial, 2, frames);
  REQUIRE(static_cast<int>(first.size()) == frames);
  REQUIRE(static_cast<int>(second.size()) == frames);
  // The robust sequence begins with white and black: nothing is brighter or darker, and each pattern of the second run
  // is as bright as in the first but for noise and flicker.
  for (int i = 0; i < frames; ++i) {
    CHECK(first[i] < first[0] + 0.5);
    CHECK(first[i] > first[1] - 0.5);
    CHECK(second[i] == Approx(first[i]).margin(0.08 * (first[0] - first[1])));
  }
  CHECK((*world)->exposures() == 2 * frames);
}

TEST_CASE("a belt that moves while the sequence runs stops it") {
  auto world = LiveWorld::start(small_cell());
  REQUIRE(world);
  REQUIRE((*world)->bring_next_parts());
  test::AravisClient client(kAddress.c_str());
  Serial serial((*world)->trigger_tty());
  protocol::Reply reply;
  serial.send(protocol::Type::kArm, sequence(7, 50));
  REQUIRE(serial.await(protocol::Type::kReply, reply));
  serial.send(protocol::Type::kStart, protocol::Start{7});
  protocol::FrameEvent frame;
  REQUIRE(serial.await(protocol::Type::kFrameEvent, frame));
  (*world)->set_belt_stopped_line(false);
  protocol::FaultEvent fault;
  REQUIRE(serial.await(protocol::Type::kFaultEvent, fault));
  CHECK(fault.fault == protocol::Fault::kBeltMoved);
}

TEST_CASE("an emulated microcontroller drives camera and projector, and has its strobes to the tick") {
  const auto settings = emulated_cell();
  if (!settings) return;
  auto world = LiveWorld::start(*settings);
  if (!world) FAIL(world.error().detail);
  REQUIRE((*world)->bring_next_parts());
  test::AravisClient client(kAddress.c_str());
  Serial serial((*world)->trigger_tty());
  constexpr int kFrames = 12;
  protocol::Reply reply;
  serial.send(protocol::Type::kArm, sequence(3, kFrames, 100));
  REQUIRE(serial.await(protocol::Type::kReply, reply));
  REQUIRE(reply.refusal == protocol::Refusal::kNone);
  serial.send(protocol::Type::kStart, protocol::Start{3});
  // However late this machine is: the strobe's own delay, and the pulse's own length, in the microcontroller's ticks.
  constexpr int kTicksPerUs = 2;
  for (int i = 0; i < kFrames; ++i) {
    protocol::FrameEvent frame;
    REQUIRE(serial.await(protocol::Type::kFrameEvent, frame));
    CHECK(frame.frame == i);
    CHECK(std::abs(static_cast<int>(frame.strobe_ticks - frame.pulse_ticks) - 20 * kTicksPerUs) <= 1);
    CHECK(std::abs(static_cast<int>(frame.strobe_length_ticks) - 8000 * kTicksPerUs) <= 1);
  }
  protocol::DoneEvent done;
  REQUIRE(serial.await(protocol::Type::kDoneEvent, done));
  for (int i = 0; i < kFrames; ++i) {
    ArvBuffer* buffer = arv_stream_timeout_pop_buffer(client.stream, 3'000'000);
    REQUIRE(buffer != nullptr);
    CHECK(arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS);
    arv_stream_push_buffer(client.stream, buffer);
  }
  CHECK((*world)->exposures() == kFrames);
}

TEST_CASE("a camera that does not run gives the emulated microcontroller no strobe") {
  const auto settings = emulated_cell();
  if (!settings) return;
  auto world = LiveWorld::start(*settings);
  REQUIRE(world);
  Serial serial((*world)->trigger_tty());
  protocol::Reply reply;
  serial.send(protocol::Type::kArm, sequence(3, 2));
  REQUIRE(serial.await(protocol::Type::kReply, reply));
  serial.send(protocol::Type::kStart, protocol::Start{3});
  protocol::FaultEvent fault;
  REQUIRE(serial.await(protocol::Type::kFaultEvent, fault));
  CHECK(fault.fault == protocol::Fault::kStrobeMissing);
}

TEST_CASE("an emulator without its firmware is refused by name") {
  const auto none = find_emulator(BELTPICK_BIN_DIR, "/nowhere/trigger.elf");
  REQUIRE_FALSE(none);
  CHECK(none.error().code == ResultCode::kFileNotFound);
  const auto no_emulator = find_emulator("/nowhere", "");
  REQUIRE_FALSE(no_emulator);
  CHECK(no_emulator.error().text().find("trigger_emulator") != std::string_view::npos);
}
