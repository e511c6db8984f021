// Whole files in and out. Written files appear complete or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace beltpick::contract_io {

// The largest file that is read: far above any real one, so that a wrong path does not fill the memory.
inline constexpr std::size_t kMaxFileBytes = std::size_t{2} << 30U;

// All bytes of a regular file. Errors: kFileNotFound, kFileUnreadable (a folder, no permission, too large).
Result<std::string> read_file(const std::filesystem::path& path, std::size_t max_bytes = kMaxFileBytes);

// Writes to a temporary beside `path`, then renames: a reader never sees half a file. A symbolic link is followed; a
// device or pipe is written to as it is. Errors: kDiskFull, kFileNotWritten.
Result<void> write_file(const std::filesystem::path& path, std::string_view bytes);

// Makes `path` and its parents. Errors: kDiskFull, kFileNotWritten.
Result<void> make_folder(const std::filesystem::path& path);

// The code of a write that ended with `error`, an errno: kDiskFull where disk or quota has no room left, else
// kFileNotWritten.
ResultCode write_error_code(int error);

// `text` with control characters replaced, so that a message stays one line whatever a file is called.
std::string one_line(std::string_view text);

}  // namespace beltpick::contract_io
