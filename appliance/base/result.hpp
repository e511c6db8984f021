// Result<T>: how an expected failure travels: a code from the contract and one line for a person.
#pragma once

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <expected>
#include <string_view>

namespace beltpick {

// The enumerators stand in contract/result_codes.hpp: base only carries them.
enum class ResultCode : std::uint16_t;

// What went wrong. `detail` is one line: what, where, expected, found, remedy. Fixed size, so that the threads that
// may not allocate can fail too.
struct Error {
  ResultCode code{};
  char detail[360]{};

  [[nodiscard]] std::string_view text() const { return detail; }
};

template <class T>
using Result = std::expected<T, Error>;

// Makes the unexpected side of a Result from a printf format. A longer text is cut, never overrun.
[[gnu::format(printf, 2, 3)]] inline std::unexpected<Error> failure(ResultCode code, const char* format, ...) {
  Error error;
  error.code = code;
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(error.detail, sizeof error.detail, format, arguments);
  va_end(arguments);
  return std::unexpected(error);
}

}  // namespace beltpick
