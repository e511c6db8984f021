// `beltpick teach --against`: whether the part just taught can be told from others that will be loaded with it.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/part_template.hpp"
#include "contract_io/json_writer.hpp"
#include "session.hpp"

namespace beltpick::cli {

struct TwinCheck {
  contract_io::Json answer;  // an entry a template
  std::string text;          // a line a template that gives no reason to worry; the others are warnings
};

// Compares the part with each template file. Errors: as read_template and twins::compare.
Result<TwinCheck> check_twins(const PartTemplate& part, const std::vector<std::string>& against,
                              const Session& session);

}  // namespace beltpick::cli
