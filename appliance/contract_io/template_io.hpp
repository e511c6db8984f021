// part.template: what `beltpick teach` writes and the appliance loads. One file, checksummed:
//   "beltpick-template 1 <crc32 of the rest, 8 hex digits> <bytes of the JSON>\n" JSON, then float32 little-endian
//   points (x y z each, mm, part frame), then as many unit normals.
// Members that came later (gripper, cones, resting_positions, routes, search_steps, requirements) may be missing: a
// template of an earlier beltpick is read, and has none. Unknown members are left alone: an earlier beltpick reads a
// later template.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/part_template.hpp"

namespace beltpick::contract_io {

// Reads a template; its name becomes the file's stem. Errors: kFileNotFound, kFileUnreadable, kFormatInvalid,
// kVersionUnsupported, kChecksumWrong, kMemberMissing, kValueOutOfRange.
Result<PartTemplate> read_template(const std::filesystem::path& path);

// The same from memory: `name` becomes the template's, `source` stands in messages.
Result<PartTemplate> parse_template(std::string_view bytes, const std::string& name, const std::string& source);

// Writes by way of a temporary file. Errors: kFileNotWritten.
Result<void> write_template(const std::filesystem::path& path, const PartTemplate& part);

}  // namespace beltpick::contract_io
