// Secrets of the service: random tokens, their comparison, and the files of the state folder that only its user may
// read.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "service/folder.hpp"

namespace beltpick::service {

// 256 random bits from the system in hex, 64 characters. Throws where the system has no randomness to give.
std::string random_token();

// Takes the same time wherever two texts of one length differ.
bool same_secret(std::string_view a, std::string_view b);

// Replaces or makes a file, mode 600, so that it is the old or the new one whatever interrupts that.
// Errors: kDiskFull, kFileNotWritten.
Result<void> write_secret(const Folder& folder, const std::string& name, std::string_view bytes);

// Takes a file away for good. Error: kFileNotWritten.
Result<void> remove_secret(const Folder& folder, const std::string& name);

}  // namespace beltpick::service
