// beltpick registers: the PLC's reference, from the one table that the appliance itself uses.
#include <algorithm>
#include <memory>

#include "commands.hpp"
#include "contract/registers.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

const char* bank_name(RegisterBank bank) { return bank == RegisterBank::kHolding ? "holding" : "input"; }

const char* type_name(RegisterType type) {
  switch (type) {
    case RegisterType::kU16:
      return "uint16";
    case RegisterType::kBits:
      return "bits";
    case RegisterType::kF32:
      return "float32";
  }
  return "";
}

int length_of(RegisterType type) { return type == RegisterType::kF32 ? 2 : 1; }

// A field of CSV (RFC 4180).
std::string field(std::string_view text) {
  if (text.find_first_of(",\"\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string registers_csv() {
  std::string csv = "bank,address,registers,type,name,meaning\n";
  for (const RegisterEntry& entry : kRegisters) {
    csv += std::string(bank_name(entry.bank)) + "," + std::to_string(entry.address) + "," +
           std::to_string(length_of(entry.type)) + "," + type_name(entry.type) + "," + field(entry.name) + "," +
           field(entry.meaning) + "\n";
  }
  return csv;
}

template <class Visitor>
void each_code(Visitor visit) {
  std::ranges::for_each(kResultCodes, visit);
  std::ranges::for_each(kFirmwareResultCodes, visit);
}

std::string codes_csv() {
  std::string csv = "code,name,cause,remedy\n";
  each_code([&](const ResultCodeEntry& entry) {
    csv += std::to_string(static_cast<int>(entry.code)) + "," + field(entry.name) + "," + field(entry.cause) + "," +
           field(entry.remedy) + "\n";
  });
  return csv;
}

std::string bank_markdown(RegisterBank bank) {
  std::string text = "| address | type | name | meaning |\n|---|---|---|---|\n";
  for (const RegisterEntry& entry : kRegisters) {
    if (entry.bank != bank) continue;
    text += "| " + std::to_string(entry.address) + " | " + type_name(entry.type) + " | `" + std::string(entry.name) +
            "` | " + std::string(entry.meaning) + " |\n";
  }
  return text;
}

std::string codes_markdown() {
  std::string text = "| code | name | what happened | what to do |\n|---|---|---|---|\n";
  each_code([&](const ResultCodeEntry& entry) {
    text += "| " + std::to_string(static_cast<int>(entry.code)) + " | `" + std::string(entry.name) + "` | " +
            std::string(entry.cause) + " | " + std::string(entry.remedy) + " |\n";
  });
  return text;
}

std::string markdown() {
  return "# PLC reference\n\n"
         "Printed by `beltpick registers`; the appliance uses the same table. Modbus TCP, any unit id, functions 3, 4, "
         "6, "
         "16 and 23.\nAddresses are zero-based, as on the wire; float32 takes two registers, high word first unless "
         "configured.\n\n"
         "## Holding registers: written by the PLC\n\n" +
         bank_markdown(RegisterBank::kHolding) + "\n## Input registers: written by the appliance\n\n" +
         bank_markdown(RegisterBank::kInput) +
         "\n## Result codes\n\nAs in the registers above, in result.json, in logs and at the command line. 200 + n is "
         "the "
         "trigger firmware's fault n.\n\n" +
         codes_markdown();
}

Json as_json() {
  Json registers = Json::array();
  for (const RegisterEntry& entry : kRegisters) {
    registers.push_back({{"bank", bank_name(entry.bank)},
                         {"address", entry.address},
                         {"registers", length_of(entry.type)},
                         {"type", type_name(entry.type)},
                         {"name", entry.name},
                         {"meaning", entry.meaning}});
  }
  Json codes = Json::array();
  each_code([&](const ResultCodeEntry& entry) {
    codes.push_back({{"code", static_cast<int>(entry.code)},
                     {"name", entry.name},
                     {"cause", entry.cause},
                     {"remedy", entry.remedy}});
  });
  return {{"registers", std::move(registers)}, {"result_codes", std::move(codes)}};
}

}  // namespace

Run add_registers(CLI::App& app) {
  const auto csv = std::make_shared<std::string>();
  app.add_option("--csv", *csv, "print one table as CSV instead of the page as Markdown: registers or codes")
      ->expected(0, 1)
      ->default_str("registers")
      ->check(CLI::IsMember({"registers", "codes"}));
  example(app, "  beltpick registers > REGISTERS.md\n  beltpick registers --csv > registers.csv");
  return [csv](Session& session) -> Result<void> {
    session.answer(as_json(), csv->empty() ? markdown() : (*csv == "codes" ? codes_csv() : registers_csv()));
    return {};
  };
}

}  // namespace beltpick::cli
