#include <catch2/catch.hpp>

#include "boot/seal.hpp"
#include "flash/avrdude.hpp"
#include "flash/programmer.hpp"

using namespace beltpick;
using namespace beltpick::flash;

namespace {

AvrdudeJob job(const char* mcu, Way way) {
  AvrdudeJob job;
  job.chip = boot::find_chip(std::string(mcu));
  job.way = way;
  job.firmware = "new firmware.hex";
  job.port = "/dev/ttyACM0";
  job.programmer = "usbasp";
  job.loader = "boot.hex";
  return job;
}

std::string command(const char* mcu, Way way) { return shell_text(avrdude_command(job(mcu, way))); }

}  // namespace

TEST_CASE("each way into the microcontroller has its avrdude command", "[avrdude]") {
  CHECK(command("atmega328p", Way::kOurLoader) ==
        "avrdude -p atmega328p -c arduino -P /dev/ttyACM0 -b 500000 -D -U 'flash:w:new firmware.hex:i'");
  CHECK(command("atmega2560", Way::kOurLoader) ==
        "avrdude -p atmega2560 -c arduino -P /dev/ttyACM0 -b 500000 -D -U 'flash:w:new firmware.hex:i'");
  CHECK(command("atmega2560", Way::kBoardLoader) ==
        "avrdude -p atmega2560 -c wiring -P /dev/ttyACM0 -b 115200 -D -U 'flash:w:new firmware.hex:i'");
  CHECK(command("atmega328p", Way::kBoardLoader) ==
        "avrdude -p atmega328p -c arduino -P /dev/ttyACM0 -b 115200 -D -U 'flash:w:new firmware.hex:i'");
  CHECK(command("atmega328p", Way::kInSystem) ==
        "avrdude -p atmega328p -c usbasp -B 8 -e -U lfuse:w:0xFF:m -U hfuse:w:0xD8:m -U efuse:w:0xFC:m "
        "-U flash:w:boot.hex:i -U 'flash:w:new firmware.hex:i' -U lock:w:0xEF:m");
}

TEST_CASE("an in-system programmer on a port is told where it is", "[avrdude]") {
  AvrdudeJob isp = job("atmega2560", Way::kInSystem);
  isp.programmer_port = "/dev/ttyUSB1";
  CHECK(shell_text(avrdude_command(isp)).find("-c usbasp -P /dev/ttyUSB1 -B 8") != std::string::npos);
}

TEST_CASE("words that a shell would take apart are quoted", "[avrdude]") {
  CHECK(shell_text({"a", "b c", "", "it's", "$x"}) == "a 'b c' '' 'it'\\''s' '$x'");
}

TEST_CASE("progress follows avrdude's marks, however its output is cut", "[avrdude]") {
  const std::string marks(50, '#');
  const std::string output = "avrdude: device signature = 0x1e950f\nReading | " + marks + " | 100% 0.0s\n\nWriting | " +
                             marks + " | 100% 0.34s\nverifying ...\nReading | " + marks.substr(0, 25);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, output.size()}) {
    AvrdudeProgress progress;
    int percent = 0;
    for (std::size_t at = 0; at < output.size(); at += piece) {
      const int now = progress.take(std::string_view(output).substr(at, piece));
      CHECK(now >= percent);
      percent = now;
    }
    CHECK(percent == 75);
  }
}

TEST_CASE("the first complaint counts, and a tty without modem lines is none", "[avrdude]") {
  CHECK(avrdude_complaint("avrdude OS error: ioctl(\"TIOCMGET\"): Inappropriate ioctl for device\n\n"
                          "avrdude error: programmer is not responding\n"
                          "avrdude error: initialization failed, rc=-1\n") == "programmer is not responding");
  CHECK(avrdude_complaint("avrdude: 11410 bytes of flash verified\n").empty());
}
