#include <unistd.h>

#include <catch2/catch.hpp>
#include <string>

#include "app/log.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

std::string drained(Log& log) {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  log.drain(ends[1]);
  close(ends[1]);
  std::string text;
  char part[4096];
  for (ssize_t got = 0; (got = read(ends[0], part, sizeof part)) > 0;) text.append(part, static_cast<std::size_t>(got));
  close(ends[0]);
  return text;
}

}  // namespace

TEST_CASE("lines come out in order, with time, level and text", "[log]") {
  Log log;
  log.write(LogLevel::kInfo, "first %d", 1);
  log.write(LogLevel::kWarning, "second");
  const std::string text = drained(log);
  CHECK(text.find("info  first 1\n") == 24);
  CHECK(text.find("warn  second\n") > text.find("first"));
  CHECK(drained(log).empty());
}

TEST_CASE("a code comes with number, name, cause and remedy", "[log]") {
  Log log;
  log.code(LogLevel::kFault, "capturing", ResultCode::kRobotInView);
  const std::string text = drained(log);
  CHECK(text.find("FAULT capturing: 110 ROBOT_IN_VIEW: the robot entered") != std::string::npos);
  CHECK(text.find("; the PLC must keep") != std::string::npos);
}

TEST_CASE("a full ring loses lines and says how many; a long line is cut", "[log]") {
  Log log;
  for (int i = 0; i < 300; ++i) log.write(LogLevel::kInfo, "line %d", i);
  CHECK(drained(log).find("44 log lines were lost") != std::string::npos);
  const std::string long_text(2000, 'x');
  log.write(LogLevel::kInfo, "%s", long_text.c_str());
  const std::string text = drained(log);
  CHECK(text.size() < 600);
  CHECK(text.back() == '\n');
}
