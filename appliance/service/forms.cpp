#include "service/forms.hpp"

#include "contract/result_codes.hpp"

namespace beltpick::service {

contract_io::Json code_json(ResultCode code) {
  const ResultCodeEntry* entry = find_result_code(code);
  return {{"code", static_cast<unsigned>(code)},
          {"name", result_code_name(code)},
          {"cause", entry != nullptr ? entry->cause : ""},
          {"remedy", entry != nullptr ? entry->remedy : ""}};
}

contract_io::Json version_json(const VersionInfo& info) {
  return {{"version", info.version}, {"sha256", info.sha256}, {"bytes", info.bytes},    {"time", info.time_utc},
          {"by", info.by},           {"origin", info.origin}, {"removed", info.removed}};
}

}  // namespace beltpick::service
