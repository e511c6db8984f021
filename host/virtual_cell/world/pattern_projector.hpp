// PatternProjector: the projector as the trigger sees it: a stored sequence, set to its start by BUSY and moved on by
// each advance pulse. Remembers which pattern stood when each exposure began.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>

#include "contract/capture.hpp"

namespace beltpick::virtual_cell {

class PatternProjector {
 public:
  explicit PatternProjector(Sequence sequence) : sequence_(std::move(sequence)) {}

  // BUSY rose: the next advance shows the first pattern.
  void rewind() {
    const std::scoped_lock lock(mutex_);
    shown_.reset();
  }
  // An advance pulse; behind the last pattern the first follows.
  void advance() {
    const std::scoped_lock lock(mutex_);
    shown_ = shown_ ? (*shown_ + 1) % sequence_.frames.size() : 0;
  }
  // The pattern that stands now; null: dark.
  [[nodiscard]] const FrameSpec* shown() const {
    const std::scoped_lock lock(mutex_);
    return shown_ ? &sequence_.frames[*shown_] : nullptr;
  }
  [[nodiscard]] const Sequence& sequence() const { return sequence_; }

 private:
  const Sequence sequence_;
  mutable std::mutex mutex_;
  std::optional<std::size_t> shown_;
};

}  // namespace beltpick::virtual_cell
