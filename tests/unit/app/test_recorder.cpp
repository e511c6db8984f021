#include <catch2/catch.hpp>

#include "app/recorder.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "small_cell.hpp"

using namespace beltpick;
using namespace beltpick::app;
namespace fs = std::filesystem;

namespace {

struct Bench {
  SmallCell cell;
  Log log;
  std::vector<std::byte> memory = std::vector<std::byte>(64U << 20U);
  Arena arena;
  ModelHub hub;
  Recorder recorder;

  explicit Bench(const std::string& frames)
      : arena(aligned(memory), memory.size() - 64),
        hub(arena, configure(frames), log),
        recorder(arena, cell.settings, log) {
    REQUIRE(hub.load());
  }

  static std::byte* aligned(std::vector<std::byte>& bytes) {
    const auto at = reinterpret_cast<std::uintptr_t>(bytes.data());
    return bytes.data() + (64 - at % 64) % 64;
  }
  const Settings& configure(const std::string& frames) {
    cell.settings.record_folder = "record";
    cell.settings.record_frames = frames;
    cell.settings.record_keep = 2;
    return cell.settings;
  }
  void capture() {
    recorder.begin();
    std::vector<std::uint8_t> pixels(64 * 48);
    for (int i = 0; i < static_cast<int>(hub.recipe().sequence.frames.size()); ++i) {
      std::fill(pixels.begin(), pixels.end(), static_cast<std::uint8_t>(i));
      recorder.keep_frame(i, {pixels.data(), 48, 64});
    }
  }
  void locate(std::uint16_t number, int grasp = 0) {
    std::vector<Vec3f> points(64 * 48, Vec3f(0, 0, 700));
    std::vector<std::uint8_t> texture(64 * 48, 100);
    std::vector<std::uint16_t> labels(64 * 48, 1);
    LocatedPart part{};
    part.grasp_index = grasp;
    RangeImage range;
    range.point_mm = {points.data(), 48, 64};
    range.texture = {texture.data(), 48, 64};
    CaptureRecord record;
    record.capture = number;
    record.range = range;
    record.labels = {labels.data(), 48, 64};
    record.parts = {&part, 1};
    recorder.keep_result(record);
  }
  [[nodiscard]] std::vector<fs::path> folders() const {
    std::vector<fs::path> found;
    if (!fs::exists(cell.folder / "record")) return found;
    for (const auto& entry : fs::directory_iterator(cell.folder / "record")) found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
  }
};

}  // namespace

TEST_CASE("a recorded capture is a CAPTURE with result and pictures; the next one waits for it", "[recorder]") {
  Bench bench("all");
  bench.capture();
  CHECK(bench.recorder.idle());
  bench.locate(5);
  CHECK_FALSE(bench.recorder.idle());
  bench.recorder.serve(bench.hub, bench.arena.shares());
  CHECK(bench.recorder.idle());
  REQUIRE(bench.folders().size() == 1);
  const fs::path folder = bench.folders().front();
  for (const char* name : {"result.json", "range_colour.png", "objects.png", "overlay.png"})
    CHECK(fs::exists(folder / name));
  contract_io::Warnings warnings;
  auto reader = contract_io::CaptureReader::open(folder, warnings);
  REQUIRE(reader);
  CHECK(reader->frames() == static_cast<int>(bench.hub.recipe().sequence.frames.size()));
  const auto image = reader->image(3, warnings);
  REQUIRE(image);
  CHECK(image->view8()(10, 10) == 3);
}

TEST_CASE("of a failed capture the frames and the reason are kept", "[recorder]") {
  Bench bench("failed");
  bench.capture();
  bench.recorder.keep_failure(9, ResultCode::kFrameBlack);
  bench.recorder.serve(bench.hub, bench.arena.shares());
  REQUIRE(bench.folders().size() == 1);
  CHECK(fs::exists(bench.folders().front() / "capture.json"));
  const auto reason = contract_io::read_file(bench.folders().front() / "failure.txt");
  REQUIRE(reason);
  CHECK(*reason == "FRAME_BLACK\n");
  bench.capture();
  bench.locate(10);
  bench.recorder.serve(bench.hub, bench.arena.shares());
  REQUIRE(bench.folders().size() == 2);
  CHECK_FALSE(fs::exists(bench.folders().back() / "capture.json"));
}

TEST_CASE("frames of captures with an object that is not offered can be kept", "[recorder]") {
  Bench bench("withheld");
  bench.capture();
  bench.locate(11, 0);
  bench.recorder.serve(bench.hub, bench.arena.shares());
  bench.capture();
  bench.locate(12, -1);
  bench.recorder.serve(bench.hub, bench.arena.shares());
  REQUIRE(bench.folders().size() == 2);
  CHECK_FALSE(fs::exists(bench.folders().front() / "capture.json"));
  CHECK(fs::exists(bench.folders().back() / "capture.json"));
}

TEST_CASE("the oldest records of a run make room", "[recorder]") {
  Bench bench("none");
  for (std::uint16_t number = 1; number <= 4; ++number) {
    bench.capture();
    bench.locate(number);
    bench.recorder.serve(bench.hub, bench.arena.shares());
  }
  REQUIRE(bench.folders().size() == 2);
  CHECK(bench.folders().front().string().ends_with("00003"));
}
