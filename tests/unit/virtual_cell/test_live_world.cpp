// The live world over its real wires: ARM and START on the serial line, frames through Aravis.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "aravis_client.hpp"
#include "contract/sequences.hpp"
#include "protocol/messages.hpp"
#include "virtual_cell/render/scene.hpp"
#include "virtual_cell/world/live_world.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

constexpr const char* kAddress = "127.0.7.2";

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

std::vector<double> capture_means(test::AravisClient& client, Serial& serial, std::uint16_t arm_id, int frames) {
  protocol::Arm arm;
  arm.arm_id = arm_id;
  arm.host_silence_ms = 60'000;
  arm.strobe_tolerance_us = 2000;
  arm.group_count = 1;
  arm.groups[0] = {static_cast<std::uint16_t>(frames), 1000, 8000, 25'000, 12'000};
  protocol::Reply reply;
  serial.send(protocol::Type::kArm, arm);
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
  test::AravisClient client(kAddress);
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
  test::AravisClient client(kAddress);
  Serial serial((*world)->trigger_tty());
  protocol::Arm arm;
  arm.arm_id = 7;
  arm.host_silence_ms = 60'000;
  arm.strobe_tolerance_us = 2000;
  arm.group_count = 1;
  arm.groups[0] = {50, 1000, 8000, 25'000, 12'000};
  protocol::Reply reply;
  serial.send(protocol::Type::kArm, arm);
  REQUIRE(serial.await(protocol::Type::kReply, reply));
  serial.send(protocol::Type::kStart, protocol::Start{7});
  protocol::FrameEvent frame;
  REQUIRE(serial.await(protocol::Type::kFrameEvent, frame));
  (*world)->set_belt_stopped_line(false);
  protocol::FaultEvent fault;
  REQUIRE(serial.await(protocol::Type::kFaultEvent, fault));
  CHECK(fault.fault == protocol::Fault::kBeltMoved);
}
