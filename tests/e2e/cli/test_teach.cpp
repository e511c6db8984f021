// beltpick teach as a stranger uses it: good and bad meshes, the report, what it says.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "contract_io/mesh_io.hpp"
#include "support/run_program.hpp"
#include "support/shapes.hpp"

using namespace beltpick;
using test::beltpick_run;
using test::TempFolder;

namespace {

// Teaches what is written to `file` in `folder`; refused in one line that holds `words`, nothing written.
void refused(const TempFolder& folder, const std::string& file, const std::string& words,
             const std::string& options = "") {
  const test::Outcome outcome = beltpick_run("teach '" + (folder / file).string() + "' --points 500 --views 0 --out " +
                                             (folder / "out/part.template").string() + " " + options);
  INFO(file << ": " << outcome.err);
  CHECK((outcome.exit_code == 1 || outcome.exit_code == 2));
  CHECK(outcome.error_lines() == 1);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.find(words) != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "out/part.template"));
}

Mesh scaled(Mesh mesh, float factor) {
  for (Vec3f& vertex : mesh.vertex_mm) vertex *= factor;
  return mesh;
}

}  // namespace

TEST_CASE("teach refuses what is no part in one line and writes nothing", "[teach]") {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "out");
  std::filesystem::create_directories(folder / "folder.stl");
  (void)folder.file("letter.stl", "Dear colleague, here is the part.\n");
  (void)folder.file("letter.obj", "Dear colleague, here is the part.\n");
  (void)folder.file("letter.ply", "Dear colleague, here is the part.\n");
  (void)folder.file("empty.stl", "");
  (void)folder.file("part.step", "ISO-10303-21;\n");
  (void)folder.file("none.stl", std::string(84, '\0'));
  REQUIRE(contract_io::write_stl(folder / "metres.stl", scaled(test::bracket(), 0.001F)).has_value());
  REQUIRE(contract_io::write_stl(folder / "good.stl", test::bracket()).has_value());
  const std::string bytes = test::file_bytes(folder / "good.stl");
  (void)folder.file("cut.stl", bytes.substr(0, bytes.size() / 2));
  refused(folder, "letter.stl", "neither binary STL nor text");
  refused(folder, "letter.obj", "no points");
  refused(folder, "letter.ply", "ply");
  refused(folder, "empty.stl", "empty file");
  refused(folder, "part.step", "CAD model");
  refused(folder, "none.stl", "no points");
  refused(folder, "metres.stl", "--units m'");
  refused(folder, "cut.stl", "cut or damaged");
  refused(folder, "folder.stl", "folder");
  refused(folder, "absent.stl", "none of that name");
  refused(folder, "good.stl", "--units", "--units furlong");
  refused(folder, "good.stl", "", "--grasps " + (folder / "letter.obj").string());
}

TEST_CASE("teach answers with what it found and what to expect, and writes a report with pictures", "[teach]") {
  const TempFolder folder;
  REQUIRE(contract_io::write_stl(folder / "bracket.stl", test::bracket()).has_value());
  const test::Outcome taught =
      beltpick_run("teach " + (folder / "bracket.stl").string() + " --units mm --points 8000 --views 3 --json --out " +
                   (folder / "bracket.template").string() + " --report " + (folder / "report").string());
  INFO(taught.err);
  REQUIRE(taught.exit_code == 0);
  const auto json = nlohmann::json::parse(taught.out);
  CHECK(json.at("rehearsal").at("views") == 3);
  CHECK(json.at("rehearsal").at("wrong") == 0);
  CHECK(json.at("rehearsal").at("search_steps").at("turn_rad").get<double>() > 0.0);
  CHECK(json.at("resting_positions").size() >= 2);
  CHECK(json.at("primitives").size() >= 4);
  const std::string page = test::file_bytes(folder / "report/index.html");
  for (const char* words : {"How it comes to rest", "How exactly it will be found", "When a pose is believed",
                            "Ways to recognise it", "<svg"}) {
    CHECK(page.find(words) != std::string::npos);
  }
  // Every picture of the page is there.
  int pictures = 0;
  for (std::size_t at = page.find("src='"); at != std::string::npos; at = page.find("src='", at + 1), ++pictures) {
    const std::string name = page.substr(at + 5, page.find('\'', at + 5) - at - 5);
    CHECK(std::filesystem::file_size(folder / ("report/" + name)) > 500);
  }
  CHECK(pictures >= 8);
}
