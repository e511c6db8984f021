// Warnings: one line each, collected while a file is read, for the caller to show.
#pragma once

#include <string>
#include <vector>

namespace beltpick::contract_io {

using Warnings = std::vector<std::string>;

}  // namespace beltpick::contract_io
