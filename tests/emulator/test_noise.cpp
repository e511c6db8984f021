// A serial line that flips or drops one byte in a hundred, each way: no command is obeyed that was not sent, and the
// link is heard again at once.
#include <algorithm>
#include <cstdio>
#include <set>

#include "base/random.hpp"
#include "emulator/rig.hpp"
#include "host/line_noise.hpp"

using namespace emulator;
using protocol::Refusal;
using protocol::Type;

namespace {

struct Command {
  Type type = Type::kStatus;
  std::uint16_t arm_id = 0;  // of an ARM or a START
  bool damaged = false;
};

class NoisyHost {
 public:
  NoisyHost(Rig& rig, std::uint32_t seed) : rig_(rig), random_(seed), there_(seed) {
    there_.set_share(kShare);
    rig_.noise_back.set_share(kShare);
  }

  // Sends the command of this number as the appliance does, a zero before it; through the noise.
  Command send(std::uint8_t sequence) {
    Command command{choose(), 0, false};
    std::vector<std::uint8_t> wire(1 + protocol::kMaxFrame);
    wire.resize(1 + write(command, sequence, wire.data() + 1));
    const std::vector<std::uint8_t> sent(wire.begin() + 1, wire.end() - 1);
    wire.resize(there_.pass(wire.data(), wire.size()));
    // The zeros around it may get lost: the next frame's end it as well.
    const auto first = std::find_if(wire.begin(), wire.end(), [](std::uint8_t byte) { return byte != 0; });
    const auto last = std::find(first, wire.end(), 0);
    command.damaged = !std::equal(first, last, sent.begin(), sent.end());
    if (!command.damaged) whole_ids.insert(command.arm_id);
    rig_.chip.send(wire);
    return command;
  }

  std::set<std::uint16_t> whole_ids;  // of the ARM that came whole

 private:
  static constexpr double kShare = 0.01;

  Type choose() {
    constexpr Type kTypes[] = {Type::kStatus,   Type::kKeepalive, Type::kAbort, Type::kClear,
                               Type::kIdentify, Type::kArm,       Type::kStart};
    return kTypes[random_.below(7)];
  }

  std::size_t write(Command& command, std::uint8_t sequence, std::uint8_t* frame) {
    constexpr std::size_t kRoom = protocol::kMaxFrame;
    if (command.type == Type::kArm) {
      command.arm_id = ++arm_id_;
      auto arm = sequence_of_two(command.arm_id);
      arm.group_count = static_cast<std::uint8_t>(1 + random_.below(3));
      return protocol::encode(command.type, sequence, arm, frame, kRoom);
    }
    if (command.type == Type::kStart)
      return protocol::encode(command.type, sequence, protocol::Start{arm_id_}, frame, kRoom);
    return protocol::encode(command.type, sequence, protocol::Empty(), frame, kRoom);
  }

  static protocol::Arm sequence_of_two(std::uint16_t arm_id) {
    auto arm = sequence(arm_id, 2);
    for (protocol::Group& group : arm.groups) group = {2, 300, 700, 1500, 700, 0};
    return arm;
  }

  Rig& rig_;
  beltpick::Random random_;
  beltpick::host::LineNoise there_;
  std::uint16_t arm_id_ = 0;
};

template <class Payload>
bool has(const Message& message) {
  Payload payload;
  return protocol::decode_payload(message.bytes.data(), message.bytes.size(), payload);
}

// A CRC of 16 bits lets one damaged message in 65536 through; the appliance then looks at its length, too.
bool is_whole_answer(const Message& message) {
  if (message.header.type == Type::kReply) return has<protocol::Reply>(message);
  if (message.header.type == Type::kIdentity) return has<protocol::Identity>(message);
  return message.header.type == Type::kStatusReport && has<protocol::StatusReport>(message);
}

const Message* answer_to(const Rig& rig, std::uint8_t sequence) {
  const auto found = std::find_if(rig.messages.begin(), rig.messages.end(), [&](const Message& message) {
    return message.header.sequence == sequence && is_whole_answer(message);
  });
  return found != rig.messages.end() ? &*found : nullptr;
}

}  // namespace

TEST_CASE("10,000 commands over a noisy line: none is obeyed that was not sent, and the link recovers within 100 ms",
          "[emulator]") {
  Rig rig(Mcu::kAtmega328p);
  NoisyHost host(rig, 3);
  std::uint64_t unanswered_since = 0;  // cycle; 0: the last one was answered
  std::uint64_t slowest = 0;
  int damaged = 0, answered = 0;
  for (int i = 0; i < 10000; ++i) {
    rig.messages.clear();
    const auto sequence = static_cast<std::uint8_t>(i);
    const std::uint64_t sent_at = rig.chip.cycle();
    const Command command = host.send(sequence);
    rig.run_us(4000);
    INFO("command " << i);
    damaged += command.damaged ? 1 : 0;
    const Message* answer = answer_to(rig, sequence);
    if (command.damaged) REQUIRE(answer == nullptr);
    if (answer == nullptr) {
      if (unanswered_since == 0) unanswered_since = sent_at;
      continue;
    }
    ++answered;
    if (unanswered_since != 0) slowest = std::max(slowest, rig.chip.cycle() - unanswered_since);
    unanswered_since = 0;
    if (answer->header.type == Type::kStatusReport) {
      const std::uint16_t armed = answer->as<protocol::StatusReport>().arm_id;
      REQUIRE((armed == 0 || host.whole_ids.contains(armed)));
    }
  }
  std::printf("noise: %d of 10,000 commands damaged, %d answered, the longest silence %.1f ms\n", damaged, answered,
              static_cast<double>(slowest) / (1000.0 * kCyclesPerUs));
  CHECK(damaged > 1000);
  CHECK(answered > 6000);
  CHECK(slowest <= 100'000 * kCyclesPerUs);
}
