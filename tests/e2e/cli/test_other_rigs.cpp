// `beltpick decode` of captures that users of other rigs bring: decoded to the truth, or refused with the reason.
#include <catch2/catch.hpp>

#include "contract_io/npy_io.hpp"
#include "other_rig.hpp"
#include "support/run_program.hpp"

using namespace beltpick;
using namespace beltpick::test;
using nlohmann::json;

namespace {

const std::string kColumn = "column";
const std::string kRow = "row";

struct Rig {
  const char* name;
  RigSize size;
  std::vector<RigFrames> parts;  // the frames, in groups
  double close_px;               // of the truth: 99 % of the judged pixels
  double far_px;                 // farther than this, no valid pixel may be: half a period, or a cell
  RigEncode encode = png8;
  json members = json::object();
  int warnings = 0;
};

Outcome decode(const Rig& rig, const TempFolder& folder, const RigScene& scene) {
  RigFrames frames;
  for (const RigFrames& part : rig.parts) add(frames, part);
  write_rig_capture(folder, scene, frames, rig.encode, rig.members);
  return beltpick_run("decode '" + folder.path().string() + "' --code " + (folder / "code.npy").string());
}

// Of one axis: 0 column, 1 row.
void check_axis(const Rig& rig, const std::vector<float>& code, const RigScene& scene, std::size_t axis) {
  const std::vector<double>& truth = axis == 0 ? scene.column_px : scene.row_px;
  int judged = 0, close = 0, valid = 0, far = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double error = std::abs(code[2 * i + axis] - truth[i]);
    judged += scene.judged[i] ? 1 : 0;
    valid += scene.judged[i] && !std::isnan(error) ? 1 : 0;
    close += scene.judged[i] && error <= rig.close_px ? 1 : 0;
    far += error > rig.far_px ? 1 : 0;
  }
  INFO("axis " << axis << ": of " << judged << " pixels " << valid << " valid, " << close << " close; " << far
               << " far off");
  REQUIRE(judged > 100);
  CHECK(close >= 0.99 * judged);
  CHECK(far == 0);
}

void check_decodes(const Rig& rig) {
  INFO(rig.name);
  const TempFolder folder(memory_folder());
  const RigScene scene = rig_scene(rig.size);
  const Outcome outcome = decode(rig, folder, scene);
  INFO(outcome.err);
  CHECK(outcome.exit_code == 0);
  if (outcome.exit_code != 0) return;
  CHECK(outcome.error_lines() == rig.warnings);
  const auto code =
      contract_io::read_npy<float>(folder / "code.npy", {rig.size.camera_height, rig.size.camera_width, 2});
  REQUIRE(code);
  for (const std::size_t axis : {0U, 1U}) {
    const bool coded = std::any_of(rig.parts.begin(), rig.parts.end(), [&](const RigFrames& part) {
      return std::any_of(part.begin(), part.end(), [&](const RigFrame& frame) {
        return frame.entry.value("axis", "") == (axis == 0 ? kColumn : kRow);
      });
    });
    if (coded) check_axis(rig, code->values, scene, axis);
  }
}

// One line that holds `words`, and nothing written.
void check_refused(const Rig& rig, const std::string& words) {
  INFO(rig.name);
  const TempFolder folder(memory_folder());
  const Outcome outcome = decode(rig, folder, rig_scene(rig.size));
  INFO(outcome.err);
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.error_lines() == 1);
  CHECK(outcome.err.find(words) != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "code.npy"));
}

RigFrames white_black() { return {even("white"), even("black")}; }

// Phases whose shifts are nobody's equal steps, told by offset_rad alone.
RigFrames uneven(const std::string& axis, double period_px, const std::vector<double>& shifts_rad) {
  RigFrames frames;
  for (const double shift_rad : shifts_rad) frames.push_back(phase(axis, period_px, 3, 0, shift_rad));
  return frames;
}

RigFrames reversed(RigFrames frames) {
  std::reverse(frames.begin(), frames.end());
  return frames;
}

constexpr RigSize kUsual{161, 121, 1280, 800};

std::vector<RigFrames> usual() { return {phases(kColumn, 20, 6), grays(kColumn, 10, 1280), white_black()}; }

}  // namespace

TEST_CASE("Cameras and projectors of other sizes decode", "[rigs]") {
  check_decodes({"odd widths",
                 {323, 241, 1279, 801},
                 {phases(kColumn, 21, 8), grays(kColumn, 10.5, 1279), white_black()},
                 0.5,
                 5});
  check_decodes(
      {"portrait, rows", {119, 203, 480, 854}, {white_black(), phases(kRow, 16, 4), grays(kRow, 8, 854)}, 0.5, 5});
  check_decodes(
      {"tiny, both axes",
       {40, 30, 64, 48},
       {phases(kColumn, 16, 8), grays(kColumn, 8, 64), phases(kRow, 16, 8), grays(kRow, 8, 48), white_black()},
       0.5,
       5});
  check_decodes({"the camera sees past the projector",
                 {200, 150, 160, 120},
                 {phases(kColumn, 16, 5), grays(kColumn, 8, 160), phases(kRow, 15, 5), grays(kRow, 7.5, 120)},
                 0.5,
                 5});
  check_decodes(
      {"4K projector", {161, 121, 3840, 2160}, {phases(kColumn, 30, 8), grays(kColumn, 15, 3840, 0, true)}, 0.6, 8});
}

TEST_CASE("Other geometry decodes", "[rigs]") {
  const auto seen = [](double zoom) { return RigSize{161, 121, 1280, 800, zoom}; };
  for (const double zoom : {-0.9, -0.3, 0.25, 1.8}) {
    INFO("projector pixels a camera pixel: " << zoom);
    check_decodes({"steps and code", seen(zoom), usual(), 0.6, 5});
    check_decodes({"rows", seen(zoom), {phases(kRow, 20, 6), grays(kRow, 10, 800, 0, true)}, 0.6, 5});
    check_decodes(
        {"Gray alone, inverses", seen(zoom), {grays(kColumn, 2, 1280, 0, true), grays(kRow, 2, 800, 0, true)}, 2.5, 5});
    check_decodes({"coarse to fine",
                   seen(zoom),
                   {phases(kColumn, 1280, 5), phases(kColumn, 160, 5), phases(kColumn, 20, 8)},
                   0.6,
                   5});
    check_decodes({"coarse to fine, four steps",
                   seen(zoom),
                   {phases(kRow, 1024, 4), phases(kRow, 128, 4), phases(kRow, 16, 4)},
                   0.6,
                   5});
    check_decodes({"three periods",
                   seen(zoom),
                   {phases(kColumn, 18, 6), phases(kColumn, 20.5, 6), phases(kColumn, 23, 6)},
                   0.6,
                   5});
  }
}

TEST_CASE("Other projectors' gamma decodes", "[rigs]") {
  for (const double gamma : {0.6, 1.8, 2.4}) {
    INFO("gamma " << gamma);
    const RigSize size{323, 241, 1280, 800, 0.9, gamma};
    check_decodes({"steps and code", size, usual(), 0.6, 5});
    check_decodes({"three steps and code", size, {phases(kRow, 18, 3), grays(kRow, 9, 800)}, 0.9, 5});
    for (const int steps : {5, 4, 3}) {
      INFO("steps " << steps);
      check_decodes({"coarse to fine",
                     size,
                     {phases(kColumn, 1280, steps), phases(kColumn, 160, steps), phases(kColumn, 20, steps)},
                     steps == 3 ? 0.9 : 0.6,
                     5});
    }
    check_decodes({"three periods, three steps",
                   size,
                   {phases(kColumn, 18, 3), phases(kColumn, 20.5, 3), phases(kColumn, 23, 3)},
                   0.9,
                   5});
    check_decodes({"Gray alone", size, {white_black(), grays(kColumn, 2, 1280)}, 2.0, 4});
  }
}

TEST_CASE("Dim scenes, and a part alone on black ground, decode", "[rigs]") {
  for (const RigSize& size :
       {RigSize{323, 241, 1280, 800, 0.9, 1.0, 45.0}, RigSize{323, 241, 1280, 800, 0.9, 1.0, 180.0, true},
        RigSize{161, 121, 1280, 800, 0.9, 2.2, 120.0, true}, RigSize{97, 73, 1280, 800, -0.6, 1.0, 150.0, true}}) {
    INFO("camera " << size.camera_width << ", gain " << size.gain << ", lone " << size.lone);
    check_decodes({"steps and code", size, usual(), 1.5, 5});
    check_decodes({"steps and code, no references", size, {phases(kRow, 20, 6), grays(kRow, 10, 800)}, 1.5, 5});
    check_decodes({"twins", size, {phases(kColumn, 20, 6), grays(kColumn, 10, 1280, 0, true)}, 1.5, 5});
    check_decodes({"Gray alone", size, {grays(kColumn, 2, 1280, 0, true)}, 2.5, 5});
    check_decodes(
        {"coarse to fine", size, {phases(kColumn, 1280, 8), phases(kColumn, 160, 8), phases(kColumn, 20, 8)}, 1.5, 5});
    check_decodes(
        {"coarse to fine, rows", size, {phases(kRow, 20, 4), phases(kRow, 140, 4), phases(kRow, 800, 4)}, 1.5, 5});
  }
}

TEST_CASE("Exposures of which one shows next to nothing decode", "[rigs]") {
  RigFrames frames = phases(kColumn, 20, 6);
  add(frames, grays(kColumn, 10, 1280));
  for (const double short_us : {1000.0, 40.0})
    check_decodes({"two exposures", kUsual, {exposed(frames, {8000.0, short_us})}, 0.7, 5});
  check_decodes({"three exposures", kUsual, {exposed(frames, {40.0, 8000.0, 32000.0})}, 0.7, 5});
  check_refused({"lens cap", kUsual, {exposed(frames, {20.0, 10.0})}, 0, 0}, "every frame is black");
}

TEST_CASE("Images of other depths and files decode", "[rigs]") {
  check_decodes({"16 bits", kUsual, usual(), 0.6, 5, png16(65535), {{"full_scale", 65535}}});
  check_decodes({"16 bits, full scale untold", kUsual, usual(), 0.6, 5, png16(65535)});
  check_decodes({"12 bits", kUsual, usual(), 0.6, 5, png16(4095), {{"full_scale", 4095}}});
  check_decodes({"10 bits", kUsual, usual(), 0.6, 5, png16(1023), {{"full_scale", 1023}}});
  check_decodes({"BMP of 8 bits", kUsual, usual(), 0.6, 5, bmp8});
  check_decodes({"colour PNG", kUsual, usual(), 0.6, 5, colour_png_of, json::object(), 1});
  check_decodes({"colour BMP", kUsual, usual(), 0.6, 5, bmp24, json::object(), 1});
}

TEST_CASE("Other sequences decode", "[rigs]") {
  const auto both = [](auto make) {
    RigFrames f = make(kColumn);
    add(f, make(kRow));
    return f;
  };
  check_decodes({"no references", kUsual, {phases(kColumn, 20, 6), grays(kColumn, 10, 1280)}, 0.6, 5});
  check_decodes({"white alone", kUsual, {phases(kColumn, 20, 6), grays(kColumn, 10, 1280), {even("white")}}, 0.6, 5});
  check_decodes({"black alone", kUsual, {{even("black")}, grays(kColumn, 10, 1280), phases(kColumn, 20, 6)}, 0.6, 5});
  check_decodes({"low bits missing, cells of half a period",
                 kUsual,
                 {phases(kColumn, 16, 8), grays(kColumn, 1, 1280, 3, true)},
                 0.5,
                 5});
  check_decodes({"low bits missing, cells of one period",
                 kUsual,
                 {phases(kColumn, 16, 8), grays(kColumn, 1, 1280, 4, true)},
                 0.5,
                 5});
  check_decodes({"cells of one period, white and black",
                 kUsual,
                 {white_black(), phases(kColumn, 16, 8), grays(kColumn, 16, 1280)},
                 0.5,
                 5});
  check_decodes(
      {"cells of one period, nothing else", kUsual, {phases(kColumn, 16, 8), grays(kColumn, 16, 1280)}, 0.5, 5});
  check_decodes({"Gray alone, inverses", kUsual, {grays(kColumn, 1, 1280, 0, true)}, 1.0, 3});
  check_decodes({"Gray alone, inverses, low bits missing, both axes",
                 kUsual,
                 {grays(kColumn, 1, 1280, 2, true), grays(kRow, 1, 800, 2, true)},
                 2.7,
                 4.5});
  check_decodes({"Gray alone, white and black", kUsual, {white_black(), grays(kColumn, 2, 1280)}, 1.5, 3});
  check_decodes({"Gray alone, white and black after, rows", kUsual, {grays(kRow, 4, 800), white_black()}, 2.7, 4.5});
  check_decodes(
      {"three periods", kUsual, {phases(kColumn, 18, 6), phases(kColumn, 20.5, 6), phases(kColumn, 23, 6)}, 0.6, 5});
  check_decodes(
      {"coarse to fine, rows", kUsual, {phases(kRow, 800, 6), phases(kRow, 133, 6), phases(kRow, 20, 6)}, 0.6, 5});
  check_decodes({"one period over all", {40, 30, 64, 48}, {phases(kColumn, 64, 16)}, 2.5, 10});
  check_decodes({"both axes, mixed",
                 kUsual,
                 {both([](const auto& a) { return phases(a, 20, 5); }),
                  both([](const auto& a) { return grays(a, 10, a == kColumn ? 1280 : 800); })},
                 0.7,
                 5});
  check_decodes({"last step first",
                 kUsual,
                 {reversed(phases(kColumn, 20, 6)), reversed(grays(kColumn, 10, 1280, 0, true))},
                 0.6,
                 5});
  check_decodes({"an offset", kUsual, {phases(kColumn, 20, 6, -1.3), grays(kColumn, 10, 1280)}, 0.6, 5});
  check_decodes({"unequal offsets",
                 kUsual,
                 {uneven(kColumn, 20, {0.0, 0.9, 2.2, 3.0, 4.4, 5.3}), grays(kColumn, 10, 1280), white_black()},
                 0.6,
                 5});
  check_decodes({"unequal offsets, no references",
                 kUsual,
                 {uneven(kColumn, 20, {0.0, 0.9, 2.2, 3.0, 4.4, 5.3}), grays(kColumn, 10, 1280)},
                 0.6,
                 5});
  check_decodes({"a quarter turn between four (Carre's shifts)",
                 kUsual,
                 {uneven(kColumn, 20, {-2.36, -0.79, 0.79, 2.36}), grays(kColumn, 10, 1280)},
                 0.8,
                 5});
}

TEST_CASE("Three to sixteen phase steps decode", "[rigs]") {
  for (int steps = 3; steps <= 16; ++steps) {
    check_decodes({"steps", {97, 73, 640, 480}, {phases(kColumn, 18, steps), grays(kColumn, 9, 640)}, 1.0, 5});
  }
}

TEST_CASE("Captures that leave the position open are refused with the reason", "[rigs]") {
  check_refused({"one period", kUsual, {phases(kColumn, 20, 6)}, 0, 0}, "fringe order is not determined");
  check_refused({"one period, white and black", kUsual, {white_black(), phases(kRow, 20, 6)}, 0, 0}, "row axis");
  check_refused({"periods that repeat together", kUsual, {phases(kColumn, 16, 6), phases(kColumn, 32, 6)}, 0, 0},
                "fringe order is not determined");
  check_refused({"Gray without threshold", kUsual, {grays(kColumn, 1, 1280)}, 0, 0}, "no threshold");
  check_refused({"high Gray bits missing", kUsual, {phases(kColumn, 20, 6), grays(kColumn, 10, 300)}, 0, 0},
                "is missing");
  check_refused({"cells wider than the period", kUsual, {phases(kColumn, 20, 6), grays(kColumn, 40, 1280)}, 0, 0},
                "fringe order is not determined");
  check_refused({"two shifts", kUsual, {uneven(kColumn, 20, {0.0, 1.6}), grays(kColumn, 10, 1280)}, 0, 0},
                "three distinct shifts");
  check_refused({"12 bits, full scale untold", kUsual, usual(), 0, 0, png16(4095)}, "full_scale 65535 (12 bits: 4095)");
  check_refused({"10 bits, full scale untold", kUsual, usual(), 0, 0, png16(1023)}, "full_scale (12 bits: 4095)");
}
