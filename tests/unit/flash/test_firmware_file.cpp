#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "flash/firmware_file.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::flash;

namespace {

boot::FlashImage program(std::uint8_t first) {
  boot::FlashImage image;
  for (std::uint32_t at = 0; at < 300; ++at) image.put(at, static_cast<std::uint8_t>(first + at));
  return image;
}

class Folder {
 public:
  std::filesystem::path write(const boot::FlashImage& image) { return write(boot::hex_text(image)); }
  std::filesystem::path write(const std::string& text) {
    const auto path = folder_ / "program.hex";
    REQUIRE(contract_io::write_file(path, text).has_value());
    return path;
  }

 private:
  test::TempFolder folder_;
};

ResultCode code_of(const Result<Firmware>& firmware) { return firmware ? ResultCode::kOk : firmware.error().code; }

}  // namespace

TEST_CASE("a firmware tells its board and version", "[firmware]") {
  Folder folder;
  boot::FlashImage image = program(1);
  REQUIRE(boot::seal(image, *boot::find_chip(std::string("atmega2560")), {1, 2, 3}).empty());
  const auto file = folder.write(image);
  const auto firmware = read_firmware(file, "", false);
  REQUIRE(firmware.has_value());
  CHECK(firmware->chip->name == std::string("atmega2560"));
  CHECK(version_text(firmware->record) == "1.2.3");
  CHECK(!firmware->sealed_here);
  CHECK(code_of(read_firmware(file, "atmega2560", false)) == ResultCode::kOk);
  CHECK(code_of(read_firmware(file, "atmega328p", false)) == ResultCode::kFirmwareUnfit);
  CHECK(code_of(read_firmware(file, "atmega328p", true)) == ResultCode::kFirmwareUnfit);
}

TEST_CASE("a firmware with another byte than when it was built is refused", "[firmware]") {
  Folder folder;
  boot::FlashImage image = program(1);
  REQUIRE(boot::seal(image, *boot::find_chip(std::string("atmega328p")), {1, 2, 3}).empty());
  image.put(77, 0);
  CHECK(code_of(read_firmware(folder.write(image), "", false)) == ResultCode::kChecksumWrong);
}

TEST_CASE("a program of somebody else's is refused, and sealed when it is wanted all the same", "[firmware]") {
  Folder folder;
  const auto file = folder.write(program(9));
  const auto refused = read_firmware(file, "", false);
  REQUIRE(code_of(refused) == ResultCode::kFirmwareUnfit);
  CHECK(std::string(refused.error().detail).find("--any --mcu") != std::string::npos);
  CHECK(code_of(read_firmware(file, "", true)) == ResultCode::kUsage);
  const auto taken = read_firmware(file, "atmega328p", true);
  REQUIRE(taken.has_value());
  CHECK(taken->sealed_here);
  CHECK(boot::find_record(taken->image).chip == taken->chip);
}

TEST_CASE("what is no hex file is refused with the reason", "[firmware]") {
  Folder folder;
  CHECK(code_of(read_firmware("/nowhere/firmware.hex", "", false)) == ResultCode::kFileNotFound);
  CHECK(code_of(read_firmware(folder.write("\x7F"
                                           "ELF\x01\n\n"),
                              "", false)) == ResultCode::kFormatInvalid);
  CHECK(code_of(read_firmware(folder.write(""), "", false)) == ResultCode::kFormatInvalid);
}
