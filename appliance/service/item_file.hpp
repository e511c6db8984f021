// The file of one version of an item: one line of text, then the item's bytes.
//   beltpick-item 1 <seal> {"kind": ..., "name": ..., "version": ..., "sha256": ..., "bytes": ..., "time": ..., "by":
//   ..., "origin": ..., "removed": ...}
// The seal is the SHA-256 of the JSON as it stands there, and the JSON holds that of the bytes: no byte of the file can
// change, and the file cannot stand for another item or version, without being found out.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "service/store.hpp"

namespace beltpick::service {

// The longest first line.
inline constexpr std::size_t kMaxItemLine = 4096;

// The first line, with its newline. What is too long in `by` and `origin` is cut, control characters are replaced; the
// `info` is changed accordingly.
std::string item_line(const ItemId& id, VersionInfo& info);

struct ItemFile {
  VersionInfo info;
  std::size_t line_bytes = 0;  // where the item's bytes begin
};

// Checks everything. `name` stands in messages. Errors: kFormatInvalid, kChecksumWrong, kVersionUnsupported.
Result<ItemFile> parse_item(std::string_view file, const ItemId& id, std::uint32_t version, const std::string& name);

}  // namespace beltpick::service
