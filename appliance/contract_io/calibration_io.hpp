// calibration.json and cell.json.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/calibration.hpp"
#include "contract_io/warnings.hpp"

namespace beltpick::contract_io {

// Reads and judges: focal lengths and sizes positive, rotations orthonormal within 1e-3 with determinant +1. `name`
// stands in messages. Errors: kFormatInvalid, kMemberMissing, kValueOutOfRange, kVersionUnsupported; from a file also
// kFileNotFound, kFileUnreadable.
Result<Calibration> parse_calibration(std::string_view text, const std::string& name, Warnings& warnings);
Result<Calibration> read_calibration(const std::filesystem::path& path, Warnings& warnings);
// `quality`: the text of a JSON object that is written as the member of that name; left out where empty.
Result<void> write_calibration(const std::filesystem::path& path, const Calibration& calibration,
                               std::string_view quality = {});

Result<Cell> parse_cell(std::string_view text, const std::string& name, Warnings& warnings);
Result<Cell> read_cell(const std::filesystem::path& path, Warnings& warnings);
Result<void> write_cell(const std::filesystem::path& path, const Cell& cell);
// As write_cell, but members of a cell file that is there already stay as they are where `cell` does not tell them,
// those that are not known here included. Errors also as read_cell, where what is there is no cell file.
Result<void> update_cell(const std::filesystem::path& path, const Cell& cell);

}  // namespace beltpick::contract_io
