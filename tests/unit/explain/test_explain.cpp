// The explanation of a scene: it tells what the locator did, changes nothing of it, and refers to files that are there.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "explain/chapter.hpp"
#include "explain/explain.hpp"
#include "explain/q_map.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

// A bracket, so that its mirror image can be told, and a foreign plate on one belt.
struct Bench {
  Shape shape = bracket(), foreign = plate();
  LoadedPart loaded{shape};
  InArena<pipeline::Pipeline> machine{limits(), 1};
  result::PartPose truth = on_belt(shape, loaded.part, any_rotation(1), -90.0, 20.0);
  SceneImage image =
      render({{&shape, truth}, {&foreign, on_belt(foreign, template_of(foreign, 3000), Mat3::Identity(), 90.0, 0.0)}});
  explain::StoryRecorder recorder{limits()};
  std::vector<std::uint8_t> grey = std::vector<std::uint8_t>(image.point_mm.size(), 128);

  Bench() { REQUIRE(machine.made.load({&loaded.part, 1})); }

  static Limits limits() {
    Limits small = test_limits();
    small.templates = 1;
    return small;
  }
  pipeline::Located locate() {
    auto located = machine.made.locate({image.range(), image.lens, scene_light_mm(), 1});
    REQUIRE(located);
    return *located;
  }
  pipeline::Located listen() {
    machine.made.set_trace(&recorder);
    return locate();
  }
};

}  // namespace

TEST_CASE("who listens changes nothing", "[explain]") {
  Bench bench;
  const auto alone = bench.locate();
  REQUIRE(alone.found.parts.size() == 1);
  const auto pose = alone.found.parts[0].T_camera_part;
  const auto heard = bench.listen();
  REQUIRE(heard.found.parts.size() == 1);
  CHECK(heard.found.parts[0].T_camera_part == pose);
}

TEST_CASE("every segment has its chapter: located, or withheld with its reason and what was judged", "[explain]") {
  Bench bench;
  const auto located = bench.listen();
  const auto chapters = explain::chapters_of(located, bench.recorder.searches());
  REQUIRE(chapters.size() == located.objects.segments.size());
  int found = 0, withheld = 0;
  for (const auto& chapter : chapters) {
    const std::string words = explain::fate_of(chapter, located, {&bench.loaded.part, 1});
    INFO(words);
    CHECK_FALSE(words.empty());
    if (chapter.fate == explain::Fate::kLocated) {
      ++found;
      REQUIRE(chapter.judged != nullptr);
      CHECK(chapter.judged->verified());
      const auto matched = std::count_if(chapter.judged->looked.begin(), chapter.judged->looked.end(),
                                         [](const auto& one) { return one.finding == result::Finding::kMatched; });
      CHECK(static_cast<int>(chapter.judged->looked.size()) == chapter.judged->champion.evidence.points);
      CHECK(2 * matched > chapter.judged->champion.evidence.points);
    }
    if (chapter.fate == explain::Fate::kWithheld) {
      ++withheld;
      CHECK(words.find(result_code_name(chapter.withheld->reason.code)) != std::string::npos);
      CHECK_FALSE(explain::advice_of(chapter, located).empty());
    }
  }
  CHECK(found == 1);
  CHECK(withheld >= 1);
}

TEST_CASE("the Q map of a cylinder has its valley where the part lies", "[explain]") {
  const Shape shape = knuckle();
  const LoadedPart loaded(shape);
  const auto truth = on_belt(shape, loaded.part, Mat3::Identity(), 0.0, 0.0);
  explain::SearchStory search;
  search.route = pipeline::Effort::kPrimitives;
  // The hub as it would be found, without any error; shifted and turned about itself at will.
  Primitive hub = loaded.part.primitives.front();
  const Vec3 axis = truth.rotation * hub.direction;
  hub.point_mm = truth * hub.point_mm + 3.0 * axis;
  hub.direction = axis;
  search.primitives = {{0, hub}};
  for (std::size_t i = 0; i < loaded.part.point_mm.size(); i += 37) {
    search.sample.push_back({(truth * loaded.part.point_mm[i].cast<double>()).cast<float>(),
                             (truth.rotation * loaded.part.normal[i].cast<double>()).cast<float>()});
  }
  const auto maps = explain::q_maps(search, {&loaded.model(), 1});
  REQUIRE_FALSE(maps.empty());
  REQUIRE(maps[0].panels.size() == 2);
  std::size_t cells = 0;
  const explain::QPanel::Cell* least = &maps[0].panels[0].cells.front();
  for (const auto& panel : maps[0].panels) {
    cells += panel.cells.size();
    for (const auto& cell : panel.cells) {
      if (cell.mean_distance_mm < least->mean_distance_mm) least = &cell;
    }
  }
  CHECK(static_cast<int>(cells) == maps[0].tried);  // each pose of the grid has a cell of its own
  CHECK(maps[0].best_mm == Approx(least->mean_distance_mm));
  CHECK(least >= maps[0].panels[0].cells.data());
  CHECK(least < maps[0].panels[0].cells.data() + maps[0].panels[0].cells.size());  // not flipped
  CHECK(std::abs(least->x + 3.0) <= 0.5 * maps[0].panels[0].x_step + 1e-6);
  CHECK(maps[0].best_mm < 3.0);  // half a step of both beside it
}

TEST_CASE("the page refers to pictures that are there", "[explain]") {
  Bench bench;
  const auto located = bench.listen();
  const TempFolder folder;
  const ImageView<const std::uint8_t> picture(bench.grey.data(), bench.image.lens.height, bench.image.lens.width);
  REQUIRE(explain::write_explanation(folder / "why", {located,
                                                      bench.recorder,
                                                      bench.machine.made.models(),
                                                      {&bench.loaded.part, 1},
                                                      bench.image.range(),
                                                      picture,
                                                      bench.image.lens,
                                                      "a scene"}));
  const std::string page = file_bytes(folder / "why/index.html");
  int pictures = 0;
  for (std::size_t at = page.find("<img src='"); at != std::string::npos; at = page.find("<img src='", at + 1)) {
    const std::size_t begin = at + 10;
    const std::string name = page.substr(begin, page.find('\'', begin) - begin);
    CHECK(std::filesystem::exists(folder / "why" / name));
    ++pictures;
  }
  CHECK(pictures > 10);
  CHECK(page.find(">Q, mm<") != std::string::npos);
  CHECK(page.find("threshold") != std::string::npos);
  CHECK(file_bytes(folder / "why/explain.json").find("\"checks\"") != std::string::npos);
  const auto refused = explain::write_explanation(
      "/proc/no/such/folder", {located, bench.recorder, bench.machine.made.models(), {}, {}, {}, {}, ""});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ResultCode::kFileNotWritten);
}
