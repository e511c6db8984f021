#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "contract/registers.hpp"
#include "contract/result_codes.hpp"
#include "support/run_program.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

const std::filesystem::path kContract = std::filesystem::path(BELTPICK_SOURCE_DIR) / "appliance/contract";

}  // namespace

TEST_CASE("The committed PLC reference is what the program prints", "[registers]") {
  INFO("mend with: beltpick registers > appliance/contract/REGISTERS.md, and --csv for the other two");
  CHECK(beltpick_run("registers").out == file_bytes(kContract / "REGISTERS.md"));
  CHECK(beltpick_run("registers --csv").out == file_bytes(kContract / "registers.csv"));
  CHECK(beltpick_run("registers --csv codes").out == file_bytes(kContract / "result_codes.csv"));
}

TEST_CASE("Registers as JSON hold the whole table", "[registers]") {
  const Outcome outcome = beltpick_run("registers --json");
  CHECK(outcome.exit_code == 0);
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["registers"].size() == kRegisters.size());
  CHECK(json["result_codes"].size() == kResultCodes.size() + kFirmwareResultCodes.size());
  CHECK(json["registers"][0]["name"] == "command");
}

TEST_CASE("A full disk is an error, not a short answer", "[registers]") {
  const int status =
      std::system((std::string(BELTPICK_BIN_DIR) + "/beltpick registers >/dev/full 2>/dev/null").c_str());
  CHECK(WEXITSTATUS(status) == 1);
}
