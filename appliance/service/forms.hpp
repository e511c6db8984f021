// The forms that the API's answers are made of, as contract/api.hpp names them.
#pragma once

#include "contract_io/json_writer.hpp"
#include "service/self_test.hpp"
#include "service/store.hpp"

namespace beltpick::service {

// CODE.
contract_io::Json code_json(ResultCode code);
// VERSION.
contract_io::Json version_json(const VersionInfo& info);

}  // namespace beltpick::service
