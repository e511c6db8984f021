// Arena: the appliance's memory, taken in one piece at start and handed out once, with a name for each share.
//
// Two passes over the same code: a *measuring* arena (no memory) adds up what the stages will ask for, the real one is
// then made of exactly that size. After start nothing is taken any more, so nothing is ever given back.
//
// Scratch lies at the end of the memory, that of each phase of the work over that of the others: measuring a capture
// ends before its parts are located, and they are located before the next one is measured. What lies over memory that
// another phase has taken already adds nothing to the shares: they sum up to what is used.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <type_traits>

#include "base/image.hpp"

namespace beltpick {

// Phases of the work on one capture; never two at the same time over the same arena.
enum class Phase : std::uint8_t { kMeasure, kLocate };

class Arena {
  static constexpr std::size_t kAlignment = 64;
  static constexpr std::size_t kMaxShares = 96;

 public:
  struct Share {
    const char* name;
    std::size_t bytes;
  };

  // A measuring arena: hands out null spans and counts.
  Arena() = default;

  // An arena over memory of the caller's, at least 64-byte aligned.
  Arena(std::byte* memory, std::size_t bytes) : memory_(memory), capacity_(bytes / kAlignment * kAlignment) {}

  [[nodiscard]] bool measuring() const { return memory_ == nullptr; }
  [[nodiscard]] std::size_t used_bytes() const { return used_ + std::max(scratch_[0], scratch_[1]); }
  [[nodiscard]] std::span<const Share> shares() const { return {shares_.data(), share_count_}; }

  // `count` zeroed elements under `name` (a string literal; equal names are added up in shares()). When measuring, a
  // span of null. Running out is a bug in the budget, not an expected failure: abort with the name.
  template <class T>
  std::span<T> take(const char* name, std::size_t count) {
    return make<T>(claim(name, count * sizeof(T)), count);
  }

  // The same for what is written before it is read in every run of one phase: whatever the other phases leave there.
  template <class T>
  std::span<T> take_scratch(Phase phase, const char* name, std::size_t count) {
    return make<T>(claim_scratch(phase, name, count * sizeof(T)), count);
  }

  template <class T>
  ImageView<T> take_image(const char* name, int rows, int cols) {
    const auto pixels = take<T>(name, static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
    return {pixels.data(), rows, cols};
  }

 private:
  template <class T>
  static std::span<T> make(std::byte* at, std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "nothing in the arena is ever destroyed");
    if (at == nullptr) return {};
    T* first = reinterpret_cast<T*>(at);
    for (std::size_t i = 0; i < count; ++i) new (first + i) T{};
    return {first, count};
  }

  std::byte* claim(const char* name, std::size_t bytes);
  std::byte* claim_scratch(Phase phase, const char* name, std::size_t bytes);
  void check_room(const char* name, std::size_t bytes) const;
  void note_share(const char* name, std::size_t bytes);

  std::byte* memory_ = nullptr;
  std::size_t capacity_ = 0;
  std::size_t used_ = 0;                  // but for the scratch
  std::array<std::size_t, 2> scratch_{};  // by Phase
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
