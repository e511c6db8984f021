// RecipeNumbers: which recipes there are, asked by the cycle's thread without ever waiting for who fills it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace beltpick::app {

class RecipeNumbers {
 public:
  [[nodiscard]] bool has(std::uint16_t number) const { return (word(number).load() >> (number % kBits) & 1U) != 0; }

  void set(std::span<const std::uint16_t> numbers) {
    std::array<std::uint64_t, kWords> bits{};
    for (const std::uint16_t number : numbers) bits[number / kBits] |= std::uint64_t{1} << (number % kBits);
    for (std::size_t i = 0; i < kWords; ++i) words_[i] = bits[i];
  }

 private:
  static constexpr std::size_t kBits = 64, kWords = 65536 / kBits;
  [[nodiscard]] const std::atomic<std::uint64_t>& word(std::uint16_t number) const { return words_[number / kBits]; }

  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace beltpick::app
