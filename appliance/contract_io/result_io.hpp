// result.json of locate.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "base/result.hpp"
#include "contract/calibration.hpp"
#include "contract/locate_result.hpp"
#include "contract/part_template.hpp"

namespace beltpick::contract_io {

// The text of result.json. `templates` are those LocatedPart::template_index counts in; poses in the belt's and robot's
// frame are given where `cell` knows them.
std::string result_text(const LocateReport& report, std::span<const PartTemplate> templates, const Cell& cell);

// Writes it, complete or not at all. Error: kFileNotWritten.
Result<void> write_result(const std::filesystem::path& path, const LocateReport& report,
                          std::span<const PartTemplate> templates, const Cell& cell);

}  // namespace beltpick::contract_io
