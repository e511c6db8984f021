// truth.json of simulate.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/truth.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::contract_io {

// Reads truth.json; the arrays it names are read with read_npy. `name` stands in messages. Errors: kFormatInvalid,
// kMemberMissing, kValueOutOfRange, kVersionUnsupported; from a file also kFileNotFound, kFileUnreadable.
Result<Truth> parse_truth(std::string_view text, const std::string& name, Warnings& warnings);
Result<Truth> read_truth(const std::filesystem::path& path, Warnings& warnings);
Result<void> write_truth(const std::filesystem::path& path, const Truth& truth);

}  // namespace beltpick::contract_io
