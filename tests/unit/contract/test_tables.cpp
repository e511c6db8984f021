#include <catch2/catch.hpp>
#include <set>
#include <string_view>

#include "contract/registers.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;

TEST_CASE("Registers do not overlap, are named once and fit their bank", "[registers]") {
  std::set<std::pair<RegisterBank, int>> taken;
  std::set<std::string_view> names;
  for (const RegisterEntry& entry : kRegisters) {
    const int size = entry.type == RegisterType::kF32 ? 2 : 1;
    const int bank_size = entry.bank == RegisterBank::kHolding ? kHoldingRegisters : kInputRegisters;
    INFO(entry.name);
    CHECK(names.insert(entry.name).second);
    CHECK(entry.address + size <= bank_size);
    for (int i = 0; i < size; ++i) CHECK(taken.emplace(entry.bank, entry.address + i).second);
  }
}

TEST_CASE("Result codes and their names are unique, and below the firmware's", "[result_codes]") {
  std::set<ResultCode> codes;
  std::set<std::string_view> names;
  for (const ResultCodeEntry& entry : kResultCodes) {
    INFO(entry.name);
    CHECK(codes.insert(entry.code).second);
    CHECK(names.insert(entry.name).second);
    CHECK(entry.code < ResultCode::kFirmwareFaultBase);
    CHECK_FALSE(entry.cause.empty());
    CHECK(result_code_name(entry.code) == entry.name);
  }
  CHECK(result_code_name(static_cast<ResultCode>(203)) == "STROBE_DOUBLE");
  CHECK(result_code_name(static_cast<ResultCode>(299)) == "FIRMWARE_FAULT");  // of a newer firmware
  CHECK_FALSE(find_result_code(ResultCode::kFirmwareFaultBase));
}
