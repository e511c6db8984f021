// Fixed-seed damage to good files and messages, for parsers to survive.
#pragma once

#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <string_view>

#include "base/random.hpp"
#include "base/result.hpp"
#include "support/one_line.hpp"

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

// Damages what `parse` takes so many times: each is taken or refused in one line. Returns how many were refused.
inline int torture(const std::string& good, const std::function<Result<void>(const std::string&)>& parse, int mutations,
                   std::uint64_t seed) {
  const auto whole = parse(good);
  INFO((whole ? "" : whole.error().detail));
  REQUIRE(whole);
  Random random(seed);
  int refused = 0;
  for (int i = 0; i < mutations; ++i) {
    const Result<void> done = parse(mutate(good, random));
    if (done) continue;
    ++refused;
    if (!is_one_line(done.error())) FAIL("not one line: " << done.error().text());
  }
  return refused;
}

// A result without what it holds.
template <class T>
Result<void> outcome(const Result<T>& result) {
  if (!result) return std::unexpected(result.error());
  return {};
}

}  // namespace beltpick::test
