// Fixed-seed mutations of good files: a parser may accept or refuse, in one line, but never crash.
#include <zip.h>
#include <catch2/catch.hpp>
#include <functional>

#include "base/random.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/cloud_io.hpp"
#include "contract_io/npy_header.hpp"
#include "contract_io/toml_config.hpp"
#include "samples.hpp"
#include "support/mutate.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

constexpr int kMutations = 4000;
constexpr int kZipMutations = 400;  // each is a file

int torture(const std::string& good, const std::function<Result<void>(const std::string&)>& parse,
            int mutations = kMutations) {
  return test::torture(good, parse, mutations, 20240717);
}

}  // namespace

TEST_CASE("No mutation of a JSON file crashes its parser", "[mutations]") {
  CHECK(torture(kCaptureJson, [](const std::string& text) {
          Warnings warnings;
          return outcome(parse_capture(text, "capture.json", warnings));
        }) > kMutations / 2);
  CHECK(torture(kCalibrationJson, [](const std::string& text) {
          Warnings warnings;
          return outcome(parse_calibration(text, "calibration.json", warnings));
        }) > kMutations / 2);
  CHECK(torture(kCellJson, [](const std::string& text) {
          Warnings warnings;
          return outcome(parse_cell(text, "cell.json", warnings));
        }) > kMutations / 2);
}

TEST_CASE("No mutation of an image crashes its reader", "[mutations]") {
  const auto parse = [](const std::string& bytes) { return outcome(decode_grey_image(bytes, "image")); };
  CHECK(torture(encode_png(ramp8(12, 17).view8()), parse) > kMutations / 2);
  const std::vector<std::uint16_t> wide(60, 4097);
  CHECK(torture(encode_png(ImageView<const std::uint16_t>(wide.data(), 6, 10)), parse) > kMutations / 2);
  std::string palette;
  for (int i = 0; i < 256; ++i) palette += little(static_cast<std::uint64_t>(i) * 0x010101U, 4);
  CHECK(torture(bmp(7, 5, 8, palette, std::string(40, '\x10')), parse) > kMutations / 20);
  CHECK(torture(bmp(7, 5, 24, "", std::string(120, '\x10')), parse) > kMutations / 20);
}

TEST_CASE("No mutation of an array or a configuration crashes its reader", "[mutations]") {
  const std::string cloud = npy_header_text("<f4", {2, 2, 3}) + std::string(48, 'B');
  CHECK(torture(cloud, [](const std::string& bytes) {
          Warnings warnings;
          return outcome(decode_cloud(bytes, "cloud.npy", warnings));
        }) > kMutations / 4);
  const std::string toml = "a = 1\nb = [1.5, 2]\n[c]\nname = \"x\"\n[[d]]\nflag = true\n";
  CHECK(torture(toml, [](const std::string& text) {
          Result<TomlConfig> config = TomlConfig::parse(text, "cell.toml");
          if (!config) return outcome(config);
          (void)config->integer("a", 0);
          (void)config->numbers("b", 2);
          (void)config->text("c.name", "");
          (void)config->flag("d[0].flag", false);
          Warnings warnings;
          return config->finish(warnings);
        }) > kMutations / 4);
}

TEST_CASE("No mutation of a zipped capture crashes its reader", "[mutations]") {
  const TempFolder folder;
  const std::filesystem::path path = folder / "capture.zip";
  int error = 0;
  zip_t* zip = zip_open(path.c_str(), ZIP_CREATE, &error);
  REQUIRE(zip != nullptr);
  const std::string image = encode_png(ramp8(6, 8).view8());
  const auto add = [&](const std::string& name, const std::string& bytes) {
    zip_file_add(zip, name.c_str(), zip_source_buffer(zip, bytes.data(), bytes.size(), 0), 0);
  };
  const std::string header = kCaptureJson;
  add("capture.json", header);
  for (const char* name : {"000.png", "001.png", "002.png", "003.png"}) add(name, image);
  REQUIRE(zip_close(zip) == 0);
  CHECK(torture(
            file_bytes(path),
            [&](const std::string& bytes) {
              Warnings warnings;
              auto reader = CaptureReader::open(folder.file("mutated.zip", bytes), warnings);
              if (!reader) return outcome(reader);
              for (int i = 0; i < reader->frames(); ++i) {
                if (const auto frame = reader->image(i, warnings); !frame) return outcome(frame);
              }
              return Result<void>{};
            },
            kZipMutations) > kZipMutations / 4);
}
