#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "contract/result_codes.hpp"
#include "projector/hidraw.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::projector;

namespace {

void add_node(const std::filesystem::path& sysfs, const char* node, const char* id, const char* phys) {
  std::filesystem::create_directories(sysfs / node / "device");
  std::ofstream(sysfs / node / "device/uevent") << "DRIVER=hid-generic\nHID_ID=" << id << "\nHID_PHYS=" << phys << "\n";
}

}  // namespace

TEST_CASE("The projector is found among other devices by its ids, at its first interface", "[hidraw]") {
  const test::TempFolder folder;
  const std::filesystem::path sysfs = folder / "hidraw";
  CHECK(find_hidraw(0x0451, 0x6401, sysfs).empty());
  add_node(sysfs, "hidraw0", "0003:0000046D:0000C31C", "usb-1/input0");
  add_node(sysfs, "hidraw1", "0003:00000451:00006401", "usb-2/input1");
  CHECK(find_hidraw(0x0451, 0x6401, sysfs).empty());
  add_node(sysfs, "hidraw2", "0003:00000451:00006401", "usb-2/input0");
  CHECK(find_hidraw(0x0451, 0x6401, sysfs) == "/dev/hidraw2");
}

TEST_CASE("A device that is not there, or may not be opened, is named with its remedy", "[hidraw]") {
  const auto missing = HidChannel::open("/dev/hidraw-none");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ResultCode::kProjectorLost);
  CHECK(missing.error().text().find("/dev/hidraw-none") != std::string_view::npos);
}

TEST_CASE("A channel tells silence, a short report and a lost device apart", "[hidraw]") {
  int ends[2];
  REQUIRE(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends) == 0);
  HidChannel channel(ends[0]);
  CHECK(channel.receive(10).error().code == ResultCode::kProjectorSilent);
  const std::array<std::uint8_t, 64> report{1, 2, 3};
  REQUIRE(::write(ends[1], report.data(), 10) == 10);
  CHECK(channel.receive(1000).error().code == ResultCode::kProjectorWrongReply);
  REQUIRE(::write(ends[1], report.data(), 64) == 64);
  REQUIRE(channel.receive(1000).value() == report);
  REQUIRE(channel.send(report));
  std::array<std::uint8_t, 80> sent{};
  REQUIRE(::read(ends[1], sent.data(), sent.size()) == 65);
  CHECK(sent[0] == 0);  // the report's number
  CHECK(sent[3] == 3);
  ::close(ends[1]);
  CHECK(channel.receive(1000).error().code == ResultCode::kProjectorLost);
  CHECK(channel.send(report).error().code == ResultCode::kProjectorLost);
}
