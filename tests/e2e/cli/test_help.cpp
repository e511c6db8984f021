#include <catch2/catch.hpp>

#include "cli_help.hpp"

using namespace beltpick::test;

TEST_CASE("Every command has help with an example of itself, and takes --json", "[help]") {
  const auto names = listed_commands();
  CHECK(names.size() >= 2);
  for (const std::string& name : names) {
    const Outcome outcome = beltpick_run(name + " --help");
    INFO(name);
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.err.empty());
    CHECK(outcome.out.find("Example:\n  beltpick " + name) != std::string::npos);
    CHECK(outcome.out.find("--json") != std::string::npos);
  }
}

TEST_CASE("Every command refuses an unknown option in one line", "[help]") {
  for (const std::string& name : listed_commands()) {
    const Outcome outcome = beltpick_run(name + " --no-such-option");
    INFO(name << ": " << outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.error_lines() == 1);
    CHECK(outcome.out.empty());
  }
}

TEST_CASE("The program greets, tells its version and refuses what is no command", "[help]") {
  CHECK(beltpick_run("--version").out == "beltpick 0.1.0\n");
  const Outcome nothing = beltpick_run("");
  CHECK(nothing.exit_code == 2);
  CHECK(nothing.err.find("COMMAND --help") != std::string::npos);
  const Outcome unknown = beltpick_run("frobnicate");
  CHECK(unknown.exit_code == 2);
  CHECK(unknown.error_lines() == 1);
  CHECK(unknown.err.find("found 'frobnicate'") != std::string::npos);
  const Outcome option = beltpick_run("--frobnicate");
  CHECK(option.exit_code == 2);
  CHECK(option.error_lines() == 1);
}
