// Arena: the appliance's memory, taken in one piece at start and handed out once, with a name for each share.
//
// Two passes over the same code: a *measuring* arena (no memory) adds up what the stages will ask for, the real one is
// then made of exactly that size. After start nothing is taken any more, so nothing is ever given back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <type_traits>

#include "base/image.hpp"

namespace beltpick {

class Arena {
 public:
  struct Share {
    const char* name;
    std::size_t bytes;
  };

  // A measuring arena: hands out null spans and counts.
  Arena() = default;

  // An arena over memory of the caller's, at least 64-byte aligned.
  Arena(std::byte* memory, std::size_t bytes) : memory_(memory), capacity_(bytes) {}

  [[nodiscard]] bool measuring() const { return memory_ == nullptr; }
  [[nodiscard]] std::size_t used_bytes() const { return used_; }
  [[nodiscard]] std::span<const Share> shares() const { return {shares_.data(), share_count_}; }

  // `count` zeroed elements under `name` (a string literal; equal names are added up in shares()). When measuring, a
  // span of null. Running out is a bug in the budget, not an expected failure: abort with the name.
  template <class T>
  std::span<T> take(const char* name, std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "nothing in the arena is ever destroyed");
    std::byte* at = claim(name, count * sizeof(T));
    if (at == nullptr) return {};
    T* first = reinterpret_cast<T*>(at);
    for (std::size_t i = 0; i < count; ++i) new (first + i) T{};
    return {first, count};
  }

  template <class T>
  ImageView<T> take_image(const char* name, int rows, int cols) {
    const auto pixels = take<T>(name, static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
    return {pixels.data(), rows, cols};
  }

 private:
  static constexpr std::size_t kAlignment = 64;
  static constexpr std::size_t kMaxShares = 96;

  std::byte* claim(const char* name, std::size_t bytes);

  std::byte* memory_ = nullptr;
  std::size_t capacity_ = 0;
  std::size_t used_ = 0;
  std::array<Share, kMaxShares> shares_{};
  std::size_t share_count_ = 0;
};

// The one block an Arena is made over: page-aligned, touched, and locked into memory where the system allows it.
class ArenaBlock {
 public:
  explicit ArenaBlock(std::size_t bytes);  // throws std::bad_alloc at start-up only
  ~ArenaBlock();
  ArenaBlock(const ArenaBlock&) = delete;
  ArenaBlock& operator=(const ArenaBlock&) = delete;

  [[nodiscard]] std::byte* data() const { return data_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  // Locks the block; false where RLIMIT_MEMLOCK forbids it.
  [[nodiscard]] bool lock() const;

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace beltpick
