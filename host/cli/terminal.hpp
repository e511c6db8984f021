// Talking with the person at the terminal, where there is one.
#pragma once

#include <optional>
#include <string>

namespace beltpick::cli {

// Whether someone can be asked: both stdin and stderr are terminals.
bool is_interactive();

// The first line of stdin. On a terminal it is asked for with `prompt` and not shown while it is typed. Nothing at the
// end of the input.
std::optional<std::string> read_secret(const std::string& prompt);

// Asks a question; true for "y" or "yes".
bool confirm(const std::string& question);

}  // namespace beltpick::cli
