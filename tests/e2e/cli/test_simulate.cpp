// beltpick simulate: scenes of known shape and faulty captures, as a user asks for them.
#include <catch2/catch.hpp>
#include <filesystem>

#include "contract_io/capture_io.hpp"
#include "contract_io/truth_io.hpp"
#include "support/run_program.hpp"
#include "workshop.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

const std::string kSmall = "simulate --camera 320x240 --projector 228x285 --sequence fast --seed 6 ";

Truth truth_of(const std::filesystem::path& capture) {
  contract_io::Warnings warnings;
  const auto truth = contract_io::read_truth(capture / "truth.json", warnings);
  REQUIRE(truth);
  CHECK(warnings.empty());
  return *truth;
}

std::string refusal(const std::string& options) {
  const TempFolder folder;
  const Outcome outcome = beltpick_run(kSmall + options + " --out " + (folder / "refused").string());
  CHECK(outcome.exit_code != 0);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  CHECK(!std::filesystem::exists(folder / "refused/capture.json"));
  return outcome.err;
}

}  // namespace

TEST_CASE("captures of a calibration plate hold both axes and one plate in many poses", "[simulate]") {
  const TempFolder folder;
  const std::string out = (folder / "plates").string();
  REQUIRE(beltpick_run(kSmall + "--scene plate --board 9x6 --square-mm 15 --count 3 --out " + out).exit_code == 0);
  contract_io::Warnings warnings;
  const auto capture = contract_io::CaptureReader::open(folder / "plates/000", warnings);
  REQUIRE(capture);
  const auto has = [&](Axis axis) {
    return std::ranges::any_of(capture->header().sequence.frames,
                               [&](const FrameSpec& f) { return f.kind == FrameKind::kPhase && f.axis == axis; });
  };
  CHECK(has(Axis::kColumn));
  CHECK(has(Axis::kRow));
  const Truth first = truth_of(folder / "plates/000");
  const Truth last = truth_of(folder / "plates/002");
  REQUIRE(first.plate);
  REQUIRE(last.plate);
  CHECK(first.plate->columns == 9);
  CHECK(first.plate->rows == 6);
  CHECK(first.plate->corner_plate_mm == last.plate->corner_plate_mm);
  CHECK(!(first.plate->T_camera_plate == last.plate->T_camera_plate));
}

TEST_CASE("targets of known shape come with their truth", "[simulate]") {
  const TempFolder folder;
  const auto targets = [&](const std::string& scene) {
    const std::string out = (folder / "targets").string();
    REQUIRE(beltpick_run(kSmall + "--scene " + scene + " --out " + out).exit_code == 0);
    return truth_of(folder / "targets").targets;
  };
  const auto balls = targets("sphere --ball-radius-mm 15 --ball-distance-mm 80");
  REQUIRE(balls.size() == 2);
  CHECK((balls[0].point_camera_mm - balls[1].point_camera_mm).norm() == Approx(80.0));
  CHECK(targets("steps --steps 4 --rise-mm 30").front().height_mm == Approx(90.0));
  CHECK(targets("plane --height-mm 40 --tilt-deg 5").front().height_mm == Approx(40.0));
  CHECK(targets("planes").size() == 1);
  CHECK(targets("plane").empty());  // the belt itself
}

TEST_CASE("a faulty capture is written as asked, and what cannot be is refused in one line", "[simulate]") {
  const TempFolder folder;
  const std::string out = (folder / "faulty").string();
  REQUIRE(beltpick_run(kSmall + "--scene plane --fault lens-cap --out " + out).exit_code == 0);
  CHECK(beltpick_run("decode " + out).err.find("FRAME_BLACK") != std::string::npos);
  CHECK(refusal("--scene plane --fault drop:99").find("expected an image of the") != std::string::npos);
  CHECK(refusal("--scene plane --fault melt").find("found 'melt'") != std::string::npos);
  CHECK(refusal("--scene cube").find("plate-on-belt") != std::string::npos);
  CHECK(refusal("--scene plate --board 11").find("--board") != std::string::npos);
  CHECK(refusal("--scene plate --board 11x8 --square-mm 60").find("smaller --square-mm") != std::string::npos);
  CHECK(refusal("--live --board 11x8").find("emulated or host") != std::string::npos);
}
