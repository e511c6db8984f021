// A program run as a child, its output read as it comes.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace beltpick::flash {

// The path of an executable among the folders of PATH; empty when there is none.
std::string find_in_path(const std::string& program);

// Runs `path` with `command` as its arguments (its name first), stdin empty, stdout and stderr to `take` as they come.
// Ends it when it says nothing for `patience_ms`, and it ends when we do. Its exit code; 128 + n where signal n ended
// it. Error: kInternal where the system gives no process.
Result<int> run_child(const std::string& path, const std::vector<std::string>& command, int patience_ms,
                      const std::function<void(std::string_view)>& take);

}  // namespace beltpick::flash
