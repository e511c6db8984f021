// LineSpec: which line of which GPIO chip, as one text of the configuration says it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/result.hpp"

namespace beltpick::capture {

enum class LineBias : std::uint8_t { kAsIs, kPullUp, kPullDown };

struct LineSpec {
  std::string chip;         // "gpiochip0", "/dev/gpiochip0", or the chip's label
  std::string line;         // its number on the chip, or its name; empty: not wired
  bool active_low = false;  // active is the low voltage
  LineBias bias = LineBias::kAsIs;

  [[nodiscard]] bool wired() const { return !line.empty(); }
  bool operator==(const LineSpec&) const = default;
};

inline constexpr const char* kLineSpecForm = "[CHIP:]LINE [active-low] [pull-up|pull-down]";

// Reads kLineSpecForm, e.g. "17 active-low pull-up" or "gpiochip1:ESTOP"; without a chip the line is one of
// `default_chip`; an empty text is a line that is not wired. A line that is a number alone counts as one. Error:
// kValueOutOfRange with what was expected.
Result<LineSpec> parse_line_spec(const std::string& text, const std::string& default_chip);

// The line's number; nothing where it is named.
std::optional<unsigned> line_number(const LineSpec& spec);

}  // namespace beltpick::capture
