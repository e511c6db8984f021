// A serial line that flips and drops bytes: nothing that was damaged is obeyed, and what comes whole is heard again.
#include "base/random.hpp"
#include "emulator/rig.hpp"

using namespace emulator;
using protocol::Type;

namespace {

struct Command {
  Type type = Type::kStatus;
  std::uint8_t sequence = 0;
  bool damaged = false;
};

// Sends a command through the noise: each byte is flipped in a bit or dropped, once in a hundred times.
Command send_noisily(Rig& rig, beltpick::Random& random, std::uint8_t sequence) {
  constexpr Type kTypes[] = {Type::kStatus, Type::kKeepalive, Type::kAbort, Type::kClear, Type::kIdentify};
  Command command{kTypes[random.below(5)], sequence, false};
  std::uint8_t wire[protocol::kMaxFrame];
  const std::size_t size = protocol::encode(command.type, sequence, protocol::Empty(), wire, sizeof wire);
  std::vector<std::uint8_t> noisy;
  for (std::size_t i = 0; i < size; ++i) {
    const bool hit = random.below(100) == 0;
    command.damaged = command.damaged || hit;
    if (!hit) noisy.push_back(wire[i]);
    if (hit && random.below(2) == 0) noisy.push_back(static_cast<std::uint8_t>(wire[i] ^ 1U << random.below(8)));
  }
  rig.chip.send(noisy);
  return command;
}

bool answered(const Rig& rig, const Command& command) {
  for (const Message& message : rig.messages) {
    if (static_cast<std::uint8_t>(message.header.type) < 0xA0 && message.header.sequence == command.sequence)
      return true;
  }
  return false;
}

}  // namespace

TEST_CASE("10,000 commands over a noisy line: no damaged one is obeyed, every second whole one is heard",
          "[emulator]") {
  Rig rig(Mcu::kAtmega328p);
  beltpick::Random random(3);
  bool clean_before = true;
  int damaged = 0;
  for (int i = 0; i < 10000; ++i) {
    rig.messages.clear();
    const Command command = send_noisily(rig, random, static_cast<std::uint8_t>(i));
    rig.run_us(2000);
    INFO("command " << i);
    if (command.damaged) {
      ++damaged;
      REQUIRE_FALSE(answered(rig, command));
    } else if (clean_before) {
      REQUIRE(answered(rig, command));
    }
    // A whole one behind a damaged one that lost its end is lost with it; the one behind that is not.
    clean_before = !command.damaged;
  }
  CHECK(damaged > 300);
}
