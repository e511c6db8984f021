// Files with secrets in them: nobody else may read them, neither when they are written nor when they are used.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace beltpick::link {

// Reads a file of this user's own that no one else may read or write (mode 600 or less), in a folder that no one else
// may write to. Errors: kFileNotFound; kFileUnreadable, also for wrong permissions, with the chmod that mends them.
Result<std::string> read_private_file(const std::filesystem::path& path);

// Writes whole or not at all, mode 600 from the first byte, flushed to the disk; missing folders are made with mode
// 700. Error: kFileNotWritten.
Result<void> write_private_file(const std::filesystem::path& path, std::string_view bytes);

// Makes the folder that a private file is to stand in, before what cannot be undone. Error: kFileNotWritten, also where
// nothing can be written into it.
Result<void> prepare_private_folder(const std::filesystem::path& folder);

}  // namespace beltpick::link
