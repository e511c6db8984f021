// Debounce: what an input is held for to be, from its edges. Its safe level (belt moves, emergency stop pressed) counts
// with its first edge; the other level only once it has stood for the debounce time.
#pragma once

#include <cstdint>
#include <optional>

namespace beltpick::capture {

class Debounce {
 public:
  Debounce() = default;
  // `active`: the line's level at start, which counts.
  Debounce(bool safe_level, std::int64_t hold_us, bool active)
      : safe_(safe_level), raw_(active), active_(active), hold_us_(hold_us) {}

  // The line took this level at that time; the level that it has already changes nothing.
  void edge(bool active, std::int64_t at_us);
  // Time passes.
  void advance(std::int64_t now_us);

  [[nodiscard]] bool active() const { return active_; }
  // When active() will change if no edge comes.
  [[nodiscard]] std::optional<std::int64_t> due_us() const;

 private:
  bool safe_ = false;
  bool raw_ = false;
  bool active_ = false;
  std::int64_t hold_us_ = 0;
  std::int64_t since_us_ = 0;  // raw_ has its level
};

}  // namespace beltpick::capture
