// Fixed-seed damage to good files and messages, for parsers to survive.
#pragma once

#include <string>
#include <string_view>

#include "base/random.hpp"

namespace beltpick::test {

// Flips bits, overwrites, cuts, doubles or inserts; often enough with bytes that mean something to a parser.
inline std::string mutate(std::string bytes, Random& random) {
  static constexpr std::string_view kTelling = "{}[]\",:-+.eE0123456789()'\n\xff\x00\x80";
  const std::uint32_t edits = 1 + random.below(4);
  for (std::uint32_t i = 0; i < edits && !bytes.empty(); ++i) {
    const std::size_t at = random.below(static_cast<std::uint32_t>(bytes.size()));
    const char telling = kTelling[random.below(static_cast<std::uint32_t>(kTelling.size()))];
    switch (random.below(6)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 1:
        bytes[at] = telling;
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, random.below(64)));
        break;
      case 4:
        bytes.insert(at, 1, telling);
        break;
      default:
        bytes.erase(at, 1 + random.below(16));
        break;
    }
  }
  return bytes;
}

}  // namespace beltpick::test
