// A segmenter with memory of its own, for tests.
#pragma once

#include "segment/segmenter.hpp"

namespace beltpick::test {

class SegmenterWithMemory {
 public:
  explicit SegmenterWithMemory(const Limits& limits) : block_(bytes(limits)), arena_(block_.data(), block_.bytes()) {
    segmenter_.emplace(arena_, limits, segment::CreaseCut::kAvailable);
  }
  segment::Segmenter& operator*() { return *segmenter_; }
  segment::Segmenter* operator->() { return &*segmenter_; }

 private:
  static std::size_t bytes(const Limits& limits) {
    Arena measuring;
    segment::Segmenter(measuring, limits, segment::CreaseCut::kAvailable);
    return measuring.used_bytes();
  }
  ArenaBlock block_;
  Arena arena_;
  std::optional<segment::Segmenter> segmenter_;
};

}  // namespace beltpick::test
