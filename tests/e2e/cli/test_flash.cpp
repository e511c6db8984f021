// beltpick flash without a microcontroller: what it refuses, what it would do, and what it tells an avrdude that only
// takes notes. The real one, against the emulated microcontroller: tests/emulator/test_update.cpp.
#include <fcntl.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <thread>

#include "boot/seal.hpp"
#include "host/board.hpp"
#include "support/run_program.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

std::string firmware_text(const std::string& mcu) {
  boot::FlashImage image;
  for (std::uint32_t at = 0; at < 700; ++at) image.put(at, static_cast<std::uint8_t>(at));
  REQUIRE(boot::seal(image, *boot::find_chip(mcu), {1, 2, 3}).empty());
  return boot::hex_text(image);
}

std::string loader_text(const std::string& mcu) {
  boot::FlashImage image;
  for (std::uint32_t at = 0; at < 100; ++at) image.put(boot::find_chip(mcu)->loader_start + at, 1);
  return boot::hex_text(image);
}

// A folder with firmware and boot loader of both boards, and a PATH whose avrdude is a script of the test's.
class Workshop {
 public:
  Workshop() {
    for (const std::string mcu : {"atmega2560", "atmega328p"}) {
      file("trigger_" + mcu + ".hex", firmware_text(mcu));
      file("boot_" + mcu + ".hex", loader_text(mcu));
    }
  }
  ~Workshop() { ::setenv("PATH", path_.c_str(), 1); }

  std::string file(const std::string& name, const std::string& text) { return folder_.file(name, text).string(); }
  [[nodiscard]] std::string name(const std::string& name) const { return (folder_ / name).string(); }
  Outcome flash(const std::string& arguments) { return beltpick_run("flash " + arguments); }

  void avrdude_is(const std::string& script) {
    const std::string program = file("bin/avrdude", "#!/bin/sh\n" + script + "\n");
    ::chmod(program.c_str(), 0755);
    ::setenv("PATH", (name("bin") + ":" + path_).c_str(), 1);
  }
  static void no_avrdude() { ::setenv("PATH", "/nowhere", 1); }

 private:
  TempFolder folder_;
  std::string path_ = std::getenv("PATH");
};

bool refused(const Outcome& outcome, const std::string& why) {
  INFO(outcome.err);
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.find(why) != std::string::npos);
  return outcome.err.find(why) != std::string::npos;
}

}  // namespace

TEST_CASE("flash shows the avrdude command that it would run", "[flash]") {
  Workshop shop;
  Workshop::no_avrdude();  // not needed for it
  const std::string hex = shop.name("trigger_atmega2560.hex");
  const Outcome serial = shop.flash(hex + " --port /dev/ttyACM7 --dry-run");
  CHECK(serial.out == "avrdude -p atmega2560 -c arduino -P /dev/ttyACM7 -b 500000 -D -U flash:w:" + hex + ":i\n");
  CHECK(serial.exit_code == 0);
  const Outcome isp = shop.flash(hex + " --programmer usbasp --dry-run --json");
  CHECK(isp.exit_code == 0);
  CHECK(isp.out.find("\"flash:w:" + shop.name("boot_atmega2560.hex") + ":i\"") != std::string::npos);
  CHECK(isp.out.find("\"hfuse:w:0xD8:m\"") != std::string::npos);
  CHECK(isp.out.find("\"version\":\"1.2.3\"") != std::string::npos);
}

TEST_CASE("flash refuses files that are no firmware of the board, in one line", "[flash]") {
  Workshop shop;
  const std::string other = shop.file("other.hex", ":0400000001020304F2\n:00000001FF\n");
  refused(shop.flash(other + " --dry-run"), "--any --mcu");
  CHECK(shop.flash(other + " --any --dry-run").exit_code == 2);
  CHECK(shop.flash(other + " --any --mcu atmega328p --dry-run").exit_code == 0);
  refused(shop.flash(shop.name("trigger_atmega2560.hex") + " --mcu atmega328p --dry-run"), "trigger_atmega328p.hex");
  refused(shop.flash(shop.file("x.elf",
                               "\x7F"
                               "ELF")),
          "line 1");
  refused(shop.flash(shop.name("nowhere.hex")), "FILE_NOT_FOUND");
  refused(shop.flash(shop.name("trigger_atmega2560.hex") + " --programmer usbasp --dry-run --loader " +
                     shop.name("boot_atmega328p.hex")),
          "expected the boot loader of the atmega2560");
}

TEST_CASE("flash names the package that is missing, and what is wrong with the port", "[flash]") {
  Workshop shop;
  const std::string hex = shop.name("trigger_atmega328p.hex");
  Workshop::no_avrdude();
  refused(shop.flash(hex + " --port /dev/null"), "apt-get install avrdude");
  shop.avrdude_is("exit 1");
  refused(shop.flash(hex + " --port /dev/null"), "expected the trigger box's tty");
  refused(shop.flash(hex + " --port " + shop.name("no-tty")), "No such file or directory");
}

TEST_CASE("an in-system programmer gets fuses, loader, firmware and lock in one go", "[flash]") {
  Workshop shop;
  shop.avrdude_is("echo \"$@\" > " + shop.name("notes"));
  const std::string hex = shop.name("trigger_atmega328p.hex");
  const Outcome done = shop.flash(hex + " --programmer usbasp --port " + shop.name("no-tty"));
  CHECK(done.exit_code == 0);
  CHECK(done.out.find("nobody answers") != std::string::npos);
  CHECK(file_bytes(shop.name("notes")) ==
        "-p atmega328p -c usbasp -B 8 -e -U lfuse:w:0xFF:m -U hfuse:w:0xD8:m -U efuse:w:0xFC:m -U flash:w:" +
            shop.name("boot_atmega328p.hex") + ":i -U flash:w:" + hex + ":i -U lock:w:0xEF:m\n");
  shop.avrdude_is("echo 'avrdude error: could not find USB device with vid=0x16c0' >&2; exit 1");
  refused(shop.flash(hex + " --programmer usbasp --port " + shop.name("no-tty")), "could not find USB device");
}

TEST_CASE("somebody else's program is given as a copy with a record, which is gone afterwards", "[flash]") {
  Workshop shop;
  shop.avrdude_is("echo \"$@\" | sed 's/.*flash:w:\\([^ ]*\\):i -U lock.*/\\1/' > " + shop.name("path") +
                  "; cp $(cat " + shop.name("path") + ") " + shop.name("copy"));
  const std::string other = shop.file("other.hex", ":0400000001020304F2\n:00000001FF\n");
  const Outcome done = shop.flash(other + " --any --mcu atmega328p --programmer usbasp --port " + shop.name("no-tty"));
  INFO(done.err);
  CHECK(done.exit_code == 0);
  boot::FlashImage copy;
  REQUIRE(boot::read_hex(file_bytes(shop.name("copy")), copy).empty());
  CHECK(copy.byte(3) == 4);
  CHECK(boot::find_record(copy).record.length == 4);
  std::string path = file_bytes(shop.name("path"));
  path.pop_back();
  CHECK(!std::filesystem::exists(path));
}

TEST_CASE("a virtual cell's stand-in has no flash", "[flash]") {
  Workshop shop;
  shop.avrdude_is("exit 1");
  const host::Board board({.link = shop.name("trigger"), .belt_stopped = true, .on_edge = nullptr});
  const Outcome outcome = shop.flash(shop.name("trigger_atmega328p.hex") + " --port " + shop.name("trigger"));
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.err.find("stand-in") != std::string::npos);
}

TEST_CASE("a beltpickd that holds the line is named, with what to do", "[flash]") {
  Workshop shop;
  shop.avrdude_is("exit 1");
  const host::Board board({.link = shop.name("trigger"), .belt_stopped = true, .on_edge = nullptr});
  const std::string daemon = shop.name("beltpickd");
  REQUIRE(std::system(("cp \"$(command -v sleep)\" " + daemon).c_str()) == 0);
  std::thread holder([&] {
    [[maybe_unused]] const int ended =
        std::system(("exec flock --no-fork " + shop.name("trigger") + " " + daemon + " 4").c_str());
  });
  std::this_thread::sleep_for(std::chrono::seconds(1));
  refused(shop.flash(shop.name("trigger_atmega328p.hex") + " --port " + shop.name("trigger")),
          "sudo systemctl stop beltpickd");
  holder.join();
}
