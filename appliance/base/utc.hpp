// Wall-clock time as it stands in files and answers.
#pragma once

#include <string>

namespace beltpick {

// Now, "2026-01-31T12:34:56Z".
std::string now_utc();

}  // namespace beltpick
