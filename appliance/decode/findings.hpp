// Findings: what a capture shows that is not right, but leaves it usable: told as warnings, in fixed memory.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "base/result.hpp"

namespace beltpick::decode {

class Findings {
 public:
  static constexpr std::size_t kMost = 8;

  void clear() { count_ = 0; }
  // One of a kind is enough: later ones of the same code are dropped.
  void add(const Error& finding) {
    for (const Error& known : all()) {
      if (known.code == finding.code) return;
    }
    if (count_ < kMost) findings_[count_++] = finding;
  }
  [[nodiscard]] std::span<const Error> all() const { return {findings_.data(), count_}; }

 private:
  std::array<Error, kMost> findings_{};
  std::size_t count_ = 0;
};

}  // namespace beltpick::decode
