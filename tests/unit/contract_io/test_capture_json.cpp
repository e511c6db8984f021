#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "contract_io/capture_io.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

void refused(const char* pointer, const nlohmann::json& value, ResultCode code, std::string_view words) {
  nlohmann::json json = nlohmann::json::parse(kCaptureJson);
  json[nlohmann::json::json_pointer(pointer)] = value;
  Warnings warnings;
  const auto header = parse_capture(json.dump(), "capture.json", warnings);
  REQUIRE_FALSE(header);
  INFO(header.error().text());
  CHECK(header.error().code == code);
  CHECK(mentions(header.error(), words));
  CHECK(is_one_line(header.error()));
}

}  // namespace

TEST_CASE("capture.json is read as the design says", "[capture]") {
  Warnings warnings;
  const auto header = parse_capture(kCaptureJson, "capture.json", warnings);
  REQUIRE(header);
  CHECK(warnings.empty());
  CHECK(header->full_scale == 255);
  CHECK(header->sequence.projector.height == 1140);
  const auto& frames = header->sequence.frames;
  REQUIRE(frames.size() == 4);
  CHECK(frames[0].kind == FrameKind::kPhase);
  CHECK(frames[0].period_px == 18);
  CHECK(frames[0].offset_rad == 0.5);
  CHECK(frames[0].exposure_us == 8000);
  CHECK(frames[1].axis == Axis::kRow);
  CHECK(frames[1].bit == 6);
  CHECK(frames[1].inverted);
  CHECK(frames[3].kind == FrameKind::kBlack);
}

TEST_CASE("Wrong members of capture.json are named", "[capture]") {
  refused("/frames/0/kind", "sine", ResultCode::kValueOutOfRange, "frames[0].kind: expected one of \"phase\"");
  refused("/frames/0/steps", 2, ResultCode::kValueOutOfRange, "frames[0].steps");
  refused("/frames/0/step", 8, ResultCode::kValueOutOfRange, "frames[0].step");
  refused("/frames/0/period_px", 0, ResultCode::kValueOutOfRange, "frames[0].period_px");
  refused("/frames/0/axis", nullptr, ResultCode::kValueOutOfRange, "frames[0].axis");
  refused("/frames/1/cell_px", 0, ResultCode::kValueOutOfRange, "frames[1].cell_px");
  refused("/frames/1/bit", -1, ResultCode::kValueOutOfRange, "frames[1].bit");
  refused("/frames/1/bit", 1e300, ResultCode::kValueOutOfRange, "frames[1].bit");
  refused("/frames/1/inverted", 1, ResultCode::kFormatInvalid, "true or false");
  refused("/frames/2/file", "../secret.png", ResultCode::kValueOutOfRange, "frames[2].file");
  refused("/frames/2/file", "/etc/passwd", ResultCode::kValueOutOfRange, "frames[2].file");
  refused("/frames/2/file", "", ResultCode::kValueOutOfRange, "frames[2].file");
  refused("/frames/2", "white", ResultCode::kFormatInvalid, "frames[2]: expected an object");
  refused("/frames", nlohmann::json::array(), ResultCode::kValueOutOfRange, "frames");
  refused("/frames", "none", ResultCode::kFormatInvalid, "frames: expected an array of objects");
  refused("/projector/width", -912, ResultCode::kValueOutOfRange, "projector.width");
  refused("/projector/layout", "hex", ResultCode::kValueOutOfRange, "\"diamond\", found \"hex\"");
  refused("/full_scale", 70000, ResultCode::kValueOutOfRange, "full_scale");
}

TEST_CASE("Unknown members and files named twice warn", "[capture]") {
  nlohmann::json json = nlohmann::json::parse(kCaptureJson);
  json["operator"] = "Ann";
  json["frames"][3]["gain"] = 2;
  json["frames"][3]["file"] = "002.png";
  Warnings warnings;
  REQUIRE(parse_capture(json.dump(), "capture.json", warnings));
  REQUIRE(warnings.size() == 3);
  CHECK(warnings[0].find("frames[3].gain") != std::string::npos);
  CHECK(warnings[1].find("also that of frames[2]") != std::string::npos);
  CHECK(warnings[2].find("operator") != std::string::npos);
}

TEST_CASE("capture.json and sequence.json read back as written", "[capture]") {
  const TempFolder folder;
  const auto sequence =
      make_sequence(SequenceName::kRobust, {912, 1140, ProjectorLayout::kDiamond}, SequenceAxes::kBoth);
  REQUIRE(sequence);
  Warnings warnings;
  REQUIRE(write_sequence(folder / "sequence.json", *sequence));
  const auto back = read_sequence(folder / "sequence.json", warnings);
  REQUIRE(back);
  CHECK(back->projector.layout == ProjectorLayout::kDiamond);
  REQUIRE(back->frames.size() == sequence->frames.size());
  for (std::size_t i = 0; i < back->frames.size(); ++i) {
    const FrameSpec& a = back->frames[i];
    const FrameSpec& b = sequence->frames[i];
    CHECK(std::tie(a.file, a.kind, a.axis, a.period_px, a.steps, a.step, a.cell_px, a.bit, a.inverted) ==
          std::tie(b.file, b.kind, b.axis, b.period_px, b.steps, b.step, b.cell_px, b.bit, b.inverted));
  }
  const CaptureHeader header{*sequence, 4095, "lap 7"};
  REQUIRE(write_capture(folder / "capture.json", header));
  const auto capture = parse_capture(file_bytes(folder / "capture.json"), "capture.json", warnings);
  REQUIRE(capture);
  CHECK(capture->full_scale == 4095);
  CHECK(capture->id == "lap 7");
  CHECK(warnings.empty());
}

TEST_CASE("Where frames lie in a projector's flash is kept, and wrong places are named", "[capture]") {
  const TempFolder folder;
  Sequence sequence;
  sequence.projector = {912, 1140, ProjectorLayout::kDiamond};
  FrameSpec white;
  white.file = "000.png";
  sequence.frames = {white};
  sequence.flash = {{1, 16, 1}};
  REQUIRE(write_sequence(folder / "sequence.json", sequence));
  Warnings warnings;
  const auto back = read_sequence(folder / "sequence.json", warnings);
  REQUIRE(back);
  CHECK(back->flash == sequence.flash);
  CHECK(warnings.empty());
  const auto place = [](int image, int plane, int bits) {
    return nlohmann::json{{"frames", {{{"image", image}, {"first_plane", plane}, {"bits", bits}}}}};
  };
  refused("/flash", place(-1, 0, 1), ResultCode::kValueOutOfRange, "flash.frames[0].image");
  refused("/flash", place(0, 24, 1), ResultCode::kValueOutOfRange, "flash.frames[0].first_plane");
  refused("/flash", place(0, 0, 9), ResultCode::kValueOutOfRange, "flash.frames[0].bits");
  refused("/flash", {{"frames", 3}}, ResultCode::kFormatInvalid, "flash.frames");
}
