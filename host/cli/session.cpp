#include "session.hpp"

#include <cstdio>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::cli {

void Session::answer(const contract_io::Json& machine, const std::string& person) {
  const std::string text = json ? contract_io::json_text(machine) : person;
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void Session::warn(const contract_io::Warnings& warnings) const {
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "beltpick %s: warning: %s\n", command_.c_str(), contract_io::one_line(warning).c_str());
  }
}

void Session::fail(const Error& error) const {
  std::fprintf(stderr, "beltpick %s: %s [%s]\n", command_.c_str(), contract_io::one_line(error.text()).c_str(),
               std::string(result_code_name(error.code)).c_str());
}

}  // namespace beltpick::cli
