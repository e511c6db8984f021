// What the firmware tells of its own start: board, limits, flash, cause of the reset; and what it takes of its chip.
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "boot/seal.hpp"
#include "emulator/rig.hpp"

using namespace emulator;
namespace boot = beltpick::boot;
using protocol::Fault;
using protocol::FlashState;
using protocol::Refusal;
using protocol::Type;

namespace {

protocol::Identity identify(Rig& rig) { return rig.ask(Type::kIdentify, protocol::Empty()).as<protocol::Identity>(); }

boot::FlashImage sealed_firmware(Mcu mcu) {
  std::ifstream file(firmware_file(mcu, ".hex"), std::ios::binary);
  boot::FlashImage image;
  REQUIRE(boot::read_hex({std::istreambuf_iterator<char>(file), {}}, image).empty());
  return image;
}

// Where the C library's last two instructions stand, which are never reached: "cli" and "jump to myself".
std::uint32_t dead_end(const boot::FlashImage& image) {
  constexpr std::array<std::uint8_t, 4> kCode{0xF8, 0x94, 0xFF, 0xCF};
  for (std::uint32_t at = image.end(0x7000); at-- > 0;) {
    std::uint32_t same = 0;
    while (same < kCode.size() && image.byte(at + same) == kCode[same]) ++same;
    if (same == kCode.size()) return at;
  }
  FAIL("no end of the program");
  return 0;
}

// Bytes of a program's sections.
std::map<std::string, std::size_t> sections(const std::string& elf) {
  FILE* pipe = ::popen(("avr-size -A " + elf).c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text.push_back(static_cast<char>(c));
  ::pclose(pipe);
  std::map<std::string, std::size_t> bytes;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    std::size_t size = 0;
    if (words >> name >> size) bytes[name] = size;
  }
  return bytes;
}

}  // namespace

TEST_CASE("the firmware identifies itself, its board, its limits and its flash", "[emulator]") {
  const Mcu mcu = GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p);
  Rig rig(mcu);
  const auto identity = identify(rig);
  CHECK(identity.board ==
        (mcu == Mcu::kAtmega2560 ? protocol::BoardKind::kAtmega2560 : protocol::BoardKind::kAtmega328p));
  CHECK(identity.tick_ns == 500);
  CHECK(identity.min_exposure_us == 50);
  CHECK(identity.max_exposure_us == protocol::kMaxExposure_us);
  CHECK(identity.min_period_us == 500);
  CHECK(identity.max_period_us == protocol::kMaxPeriod_us);
  CHECK(identity.min_interval_us == 50);
  CHECK(identity.reset_cause == protocol::kResetPowerOn);
  CHECK(identity.flash_crc == rig.chip.flash_crc());
  CHECK(identity.flash_state == FlashState::kUnsealed);  // an ELF holds no record
  CHECK(rig.status().fault == Fault::kNone);
  CHECK(rig.safe());
}

TEST_CASE("a flash that is what its record says is whole; with one bit wrong it is a fault that stays", "[emulator]") {
  const Mcu mcu = GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p);
  boot::FlashImage image = sealed_firmware(mcu);
  {
    Rig rig(mcu, image);
    CHECK(identify(rig).flash_state == FlashState::kWhole);
    CHECK(rig.status().fault == Fault::kNone);
  }
  const std::uint32_t record_at = boot::record_address(*boot::find_record(image).chip);
  const std::uint32_t damaged_at = GENERATE_COPY(dead_end(image), record_at + 5);
  image.put(damaged_at, image.byte(damaged_at) ^ 0x10U);
  Rig rig(mcu, image);
  CHECK(identify(rig).flash_state == FlashState::kDamaged);
  CHECK(rig.status().fault == Fault::kFlashDamaged);
  CHECK(rig.chip.level(Out::kFault));
  CHECK(rig.request(Type::kClear, protocol::Empty()) == Refusal::kFlashDamaged);
  CHECK(rig.request(Type::kArm, sequence(1, 1)) == Refusal::kFaultLatched);
  CHECK(rig.safe());
}

TEST_CASE("a brown-out in the middle of a sequence: safe pins, a fault that tells it, and the way out", "[emulator]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  rig.arm_and_start(sequence(1, 9));
  rig.run_us(15000);
  REQUIRE(rig.chip.level(Out::kCamera));
  rig.chip.brown_out();
  rig.run_us(200000);
  CHECK(rig.safe());
  CHECK(rig.chip.level(Out::kFault));
  CHECK(identify(rig).reset_cause == protocol::kResetBrownOut);
  const auto faults = rig.events<protocol::FaultEvent>(Type::kFaultEvent);
  REQUIRE_FALSE(faults.empty());
  CHECK(faults.back().fault == Fault::kBrownOut);
  rig.chip.set_pin(In::kStrobe, false);
  rig.run_us(1000);
  REQUIRE(rig.request(Type::kClear, protocol::Empty()) == Refusal::kNone);
  rig.arm_and_start(sequence(2, 3));
  rig.run_us(45000);
  CHECK(rig.status().state == protocol::State::kDone);
}

TEST_CASE("a reset by its pin is no fault: the PC's serial driver does that", "[emulator]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  rig.chip.reset_by_pin();
  rig.run_us(200000);
  CHECK(identify(rig).reset_cause == protocol::kResetExternal);
  CHECK(rig.status().fault == Fault::kNone);
}

TEST_CASE("the smallest board has room: 24 KB of flash, 1.5 KB of RAM with the stack", "[emulator]") {
  auto bytes = sections(firmware_file(Mcu::kAtmega328p, ".elf"));
  const std::size_t flash = bytes[".text"] + bytes[".data"];
  const std::size_t ram = bytes[".data"] + bytes[".bss"] + bytes[".noinit"];
  REQUIRE(bytes[".text"] > 0);
  REQUIRE(bytes[".bss"] > 0);

  Rig rig(Mcu::kAtmega328p);
  auto longest = sequence(1, 2);
  longest.group_count = protocol::kMaxGroups;
  for (protocol::Group& group : longest.groups) group = longest.groups[0];
  rig.arm_and_start(longest);
  for (int i = 0; i < 150; ++i) {
    rig.post(i % 3 == 0 ? Type::kIdentify : Type::kStatus, protocol::Empty());
    if (i % 10 == 0) rig.post(Type::kArm, longest);
    rig.run_us(2000);
  }
  CHECK(rig.status().state == protocol::State::kDone);
  const std::size_t stack = rig.chip.stack_bytes();
  std::printf("ATmega328P: %zu bytes of flash, %zu of RAM and %zu of stack\n", flash, ram, stack);
  CHECK(flash <= 24 * 1024);
  CHECK(ram + stack <= 1536);
}
