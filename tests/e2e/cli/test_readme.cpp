// The commands of README and of the page on calibration, run as they stand there, one after the other in an empty
// folder.
#include <catch2/catch.hpp>
#include <sstream>

#include "cli_help.hpp"

using namespace beltpick::test;

namespace {

const std::string kReadme = file_bytes(std::filesystem::path(BELTPICK_SOURCE_DIR) / "README.md");
const std::string kCalibrating = file_bytes(std::filesystem::path(BELTPICK_SOURCE_DIR) / "host/calibrate/README.md");

// The lines of the blocks marked as shell.
std::vector<std::string> shell_lines(const std::string& page) {
  std::vector<std::string> lines;
  std::istringstream text(page);
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```")) {
      inside = line == "```sh";
    } else if (inside) {
      lines.push_back(line);
    }
  }
  return lines;
}

// Runs `lines` one after the other in `folder`; how many there were.
std::size_t run_all(const std::vector<std::string>& lines, const TempFolder& folder) {
  for (const std::string& line : lines) {
    const std::string command = "cd '" + folder.path().string() + "' && export PATH=" + BELTPICK_BIN_DIR +
                                ":$PATH && " + line + " >/dev/null 2>stderr.txt";
    const int status = std::system(command.c_str());
    INFO(line << "\n" << file_bytes(folder / "stderr.txt"));
    REQUIRE(status == 0);
  }
  return lines.size();
}

}  // namespace

TEST_CASE("The README's commands work as they stand there", "[readme]") {
  const TempFolder folder;
  CHECK(run_all(shell_lines(kReadme), folder) >= 7);
  CHECK(std::filesystem::file_size(folder / "result.json") > 0);
}

TEST_CASE("The commands of the page on calibration work as they stand there", "[readme][calibrate]") {
  const TempFolder folder;
  CHECK(run_all(shell_lines(kCalibrating), folder) >= 6);
  CHECK(file_bytes(folder / "report/index.html").find("Calibration good") != std::string::npos);
}

TEST_CASE("The README names every command and no other", "[readme]") {
  for (const std::string& name : listed_commands()) {
    INFO(name);
    CHECK(kReadme.find("\n| `" + name + "` |") != std::string::npos);
  }
}

TEST_CASE("The README's links lead somewhere", "[readme]") {
  const std::regex link("\\]\\(([^)#]+)\\)");
  for (std::sregex_iterator at(kReadme.begin(), kReadme.end(), link), end; at != end; ++at) {
    const std::string target = (*at)[1];
    if (target.starts_with("http")) continue;
    INFO(target);
    CHECK(std::filesystem::exists(std::filesystem::path(BELTPICK_SOURCE_DIR) / target));
  }
}
