#include <catch2/catch.hpp>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/capture_io.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;
namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kFiles{"000.png", "001.png", "002.png", "003.png"};

// A capture folder of four frames of 8 x 6 pixels.
void make_capture(const fs::path& folder) {
  fs::create_directories(folder);
  std::ofstream(folder / "capture.json") << kCaptureJson;
  for (const std::string& file : kFiles) REQUIRE(write_png(folder / file, ramp8(6, 8).view8()));
}

void reads_whole(const fs::path& path, const std::string& id) {
  Warnings warnings;
  auto reader = CaptureReader::open(path, warnings);
  REQUIRE(reader);
  CHECK(reader->header().id == id);
  CHECK(reader->rows() == 6);
  CHECK(reader->cols() == 8);
  CHECK(reader->frames() == 4);
  for (int i = 0; i < reader->frames(); ++i) {
    const auto image = reader->image(i, warnings);
    REQUIRE(image);
    CHECK(image->pixels8 == ramp8(6, 8).pixels8);
  }
  CHECK(warnings.empty());
}

Error refused(const fs::path& path) {
  Warnings warnings;
  auto reader = CaptureReader::open(path, warnings);
  REQUIRE_FALSE(reader);
  INFO(reader.error().text());
  CHECK(is_one_line(reader.error()));
  return reader.error();
}

}  // namespace

TEST_CASE("A capture is read from a folder, its json, and a zip of either form", "[capture]") {
  const TempFolder folder;
  make_capture(folder / "lap 1");
  reads_whole(folder / "lap 1", "lap 1");
  reads_whole(folder / "lap 1/", "lap 1");
  reads_whole(folder / "lap 1/capture.json", "lap 1");
  REQUIRE(zip_folder(folder / "lap 1", folder / "root.zip", ""));
  reads_whole(folder / "root.zip", "root");
  REQUIRE(zip_folder(folder / "lap 1", folder / "nested.zip", "lap 1/"));
  reads_whole(folder / "nested.zip", "nested");
}

TEST_CASE("Frames beside a sequence.json make a capture", "[capture]") {
  const TempFolder folder;
  make_capture(folder / "c");
  nlohmann::json json = nlohmann::json::parse(kCaptureJson);
  json["format"] = "beltpick-sequence";
  json.erase("full_scale");
  std::ofstream(folder / "c/sequence.json") << json;
  fs::remove(folder / "c/capture.json");
  reads_whole(folder / "c", "c");
}

TEST_CASE("The full scale defaults to the depth of the images", "[capture]") {
  const TempFolder folder;
  make_capture(folder / "c");
  nlohmann::json json = nlohmann::json::parse(kCaptureJson);
  json.erase("full_scale");
  std::ofstream(folder / "c/capture.json") << json;
  Warnings warnings;
  CHECK(CaptureReader::open(folder / "c", warnings)->header().full_scale == 255);
  const std::vector<std::uint16_t> wide(48, 1000);
  for (const std::string& file : kFiles) {
    REQUIRE(write_png(folder.path() / "c" / file, ImageView<const std::uint16_t>(wide.data(), 6, 8)));
  }
  auto reader = CaptureReader::open(folder / "c", warnings);
  REQUIRE(reader);
  CHECK(reader->header().full_scale == 65535);
  CHECK(reader->bits() == 16);
  CHECK(reader->image(1, warnings)->pixels16[3] == 1000);
}

TEST_CASE("A missing, damaged or differing frame is named", "[capture]") {
  const TempFolder folder;
  make_capture(folder / "c");
  Warnings warnings;

  REQUIRE(write_png(folder / "c/002.png", ramp8(6, 9).view8()));
  auto reader = CaptureReader::open(folder / "c", warnings);
  REQUIRE(reader);
  CHECK(reader->image(1, warnings));
  const auto wider = reader->image(2, warnings);
  REQUIRE_FALSE(wider);
  CHECK(wider.error().code == ResultCode::kFrameSizeMismatch);
  CHECK(mentions(wider.error(), "002.png"));
  CHECK(mentions(wider.error(), "expected 8 x 6 pixels of 8 bits as in 000.png, found 9 x 6"));

  const std::string bytes = file_bytes(folder / "c/001.png");
  (void)folder.file("c/002.png", bytes.substr(0, bytes.size() / 2));
  const auto cut = reader->image(2, warnings);
  REQUIRE_FALSE(cut);
  CHECK(mentions(cut.error(), "002.png"));

  fs::remove(folder / "c/002.png");
  const Error missing = refused(folder / "c");
  CHECK(missing.code == ResultCode::kFrameMissing);
  CHECK(mentions(missing, "002.png"));
  fs::create_directory(folder / "c/002.png");
  CHECK(refused(folder / "c").code == ResultCode::kFrameMissing);
}

TEST_CASE("Colour frames warn once", "[capture]") {
  const TempFolder folder;
  make_capture(folder / "c");
  const std::vector<Rgb> colour(48, Rgb{1, 2, 3});
  for (const std::string& file : kFiles) {
    REQUIRE(write_png(folder.path() / "c" / file, ImageView<const Rgb>(colour.data(), 6, 8)));
  }
  Warnings warnings;
  auto reader = CaptureReader::open(folder / "c", warnings);
  REQUIRE(reader);
  for (int i = 0; i < 4; ++i) REQUIRE(reader->image(i, warnings));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("colour") != std::string::npos);
}

TEST_CASE("What is no capture is refused with what was found", "[capture]") {
  const TempFolder folder;
  CHECK(refused(folder / "nothing").code == ResultCode::kFileNotFound);
  CHECK(mentions(refused(folder.path()), "a folder without capture.json"));
  CHECK(mentions(refused(folder.file("a.txt", "hello")), "another kind of file"));
  CHECK(mentions(refused(folder.file("a.zip", "hello")), "no zip archive"));
  CHECK(refused(folder.file("b.zip", "PK\x03\x04 but no archive")).code == ResultCode::kFileUnreadable);
  CHECK(refused(folder.file("c.json", "{}")).code == ResultCode::kMemberMissing);
  make_capture(folder / "c");
  REQUIRE(zip_folder(folder / "c", folder / "deep.zip", "a/b/"));
  CHECK(mentions(refused(folder / "deep.zip"), "in its one folder"));
}

TEST_CASE("The real captures are read whole", "[capture][real]") {
  const char* environment = std::getenv("BELTPICK_REAL_DATA");
  const fs::path data =
      environment != nullptr ? fs::path(environment) : fs::path(BELTPICK_SOURCE_DIR) / "../shared/data";
  if (!fs::exists(data / "procam-gray")) {
    std::cout << "skipped: no real data at " << data << "\n";
    return;
  }
  for (int i = 0; i < 5; ++i) {
    Warnings warnings;
    auto reader = CaptureReader::open(data / "procam-gray" / ("capture_" + std::to_string(i)), warnings);
    REQUIRE(reader);
    CHECK(reader->cols() == 1280);
    CHECK(reader->rows() == 1024);
    CHECK(reader->frames() == 42);
    CHECK(reader->header().full_scale == 255);
    CHECK(reader->image(41, warnings));
    CHECK(warnings.empty());
  }
}
