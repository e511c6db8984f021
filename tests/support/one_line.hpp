// What every error message must be.
#pragma once

#include <string_view>

#include "base/result.hpp"

namespace beltpick::test {

// One line that a person can act on.
inline bool is_one_line(const Error& error) {
  const std::string_view text = error.text();
  return text.size() > 10 && text.find('\n') == std::string_view::npos;
}

inline bool mentions(const Error& error, std::string_view words) {
  return error.text().find(words) != std::string_view::npos;
}

}  // namespace beltpick::test
