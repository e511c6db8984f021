// Who writes into the state folder: the account that owns it, also when root asks for it.
#pragma once

#include <filesystem>

#include "base/result.hpp"

namespace beltpick::app {

// As root: becomes the owner of `folder` for good, so that beltpickd, which runs as that account, can read what is
// written there. Does nothing for anybody else, nor where the folder is not there or is root's. Error: kFileNotWritten.
Result<void> become_owner_of(const std::filesystem::path& folder);

}  // namespace beltpick::app
