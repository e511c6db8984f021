#include <catch2/catch.hpp>

#include "flash/child.hpp"

using namespace beltpick::flash;

namespace {

struct Ran {
  int code = -1;
  std::string output;
};

Ran shell(const std::string& script, int patience_ms = 20'000) {
  Ran ran;
  const auto code =
      run_child("/bin/sh", {"sh", "-c", script}, patience_ms, [&](std::string_view bytes) { ran.output += bytes; });
  REQUIRE(code.has_value());
  ran.code = *code;
  return ran;
}

}  // namespace

TEST_CASE("a child's output and exit code come back, whichever stream it used", "[child]") {
  const Ran ran = shell("echo one; echo two >&2; exit 3");
  CHECK(ran.code == 3);
  CHECK(ran.output == "one\ntwo\n");
}

TEST_CASE("a child that a signal ended says which; one that is not there says 127", "[child]") {
  CHECK(shell("kill -9 $$").code == 128 + 9);
  const auto code = run_child("/nowhere/avrdude", {"avrdude"}, 1000, [](std::string_view) {});
  REQUIRE(code.has_value());
  CHECK(*code == 127);
}

TEST_CASE("a child that says nothing for too long is ended", "[child]") {
  const Ran ran = shell("echo begun; exec sleep 1000", 300);
  CHECK(ran.code == 128 + 15);
  CHECK(ran.output == "begun\n");
}

TEST_CASE("a program is looked for in the folders of PATH", "[child]") {
  CHECK(!find_in_path("sh").empty());
  CHECK(find_in_path("no-such-program-anywhere").empty());
}
