// A written capture against what it was written from.
#include <catch2/catch.hpp>
#include <filesystem>

#include "contract/sequences.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/npy_io.hpp"
#include "contract_io/truth_io.hpp"
#include "virtual_cell/render/capture_folder.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

TEST_CASE("a capture folder holds frames, truth and the poses of its parts") {
  RigOptions small;
  small.camera_width = 160;
  small.camera_height = 120;
  const Rig rig = make_rig(small).value();
  const std::vector<ScenePart> parts{builtin_part("elbow").value()};
  SceneRenderer renderer(rig, parts);
  BeltPart lying;
  lying.T_belt_part.translation_mm = {0.0, 0.0, 38.0};
  const std::vector<PartInstance> instances = instances_of({lying}, rig);
  renderer.place(instances, 3);
  const Truth truth = truth_of(renderer, instances, parts);
  const Sequence sequence = make_sequence(SequenceName::kFast, {912, 1140}, SequenceAxes::kColumn).value();
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "beltpick_test_capture_folder";
  int exposed = 0;
  REQUIRE(write_capture_folder(renderer, {}, sequence, truth, {}, folder, [&] { ++exposed; }));
  CHECK(exposed == static_cast<int>(sequence.frames.size()));

  contract_io::Warnings warnings;
  auto capture = contract_io::CaptureReader::open(folder, warnings);
  REQUIRE(capture);
  CHECK(capture->frames() == exposed);
  CHECK(capture->rows() == 120);
  CHECK(capture->cols() == 160);
  CHECK(capture->header().sequence.frames[0].exposure_us == 8000.0);

  const auto read = contract_io::read_truth(folder / "truth.json", warnings);
  REQUIRE(read);
  REQUIRE(read->parts.size() == 1);
  CHECK(read->parts[0].part == "elbow");
  CHECK((read->parts[0].T_camera_part.matrix() - instances[0].T_camera_part.matrix()).norm() < 1e-9);
  CHECK(read->parts[0].visible_fraction == Approx(1.0));
  REQUIRE(read->parts[0].symmetries.size() == 1);
  CHECK((read->parts[0].symmetries[0].matrix() - parts[0].symmetries[0].matrix()).norm() < 1e-9);
  const auto labels = contract_io::read_npy<std::uint16_t>(folder / read->instances_file, {120, 160});
  REQUIRE(labels);
  CHECK(std::count(labels->values.begin(), labels->values.end(), 1) > 500);
  CHECK(contract_io::read_npy<float>(folder / read->xyz_file, {120, 160, 3}));
  CHECK(warnings.empty());
  std::filesystem::remove_all(folder);
}

TEST_CASE("a wrong truth file is refused with the member's name") {
  contract_io::Warnings warnings;
  const auto wrong = contract_io::parse_truth(
      R"({"format": "beltpick-truth", "version": 1, "xyz": "a.npy", "instances": "b.npy",
          "parts": [{"part": "elbow", "pose_camera": [[1, 0], [0, 1]], "visible_fraction": 1, "symmetries": []}]})",
      "truth.json", warnings);
  REQUIRE(!wrong);
  CHECK(wrong.error().text().find("pose_camera") != std::string_view::npos);
}
