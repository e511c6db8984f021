// PairTable: what was counted at the border of each pair of neighbouring labels; a small open hash of fixed size.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/arena.hpp"

namespace beltpick::segment {

template <class Count>
class PairTable {
 public:
  struct Entry {
    std::uint16_t a = 0;  // a < b; 0: free
    std::uint16_t b = 0;
    Count count{};
  };

  explicit PairTable(Arena& arena) : entries_(arena.take<Entry>("segment: borders", kEntries)) {}

  void clear() { std::fill(entries_.begin(), entries_.end(), Entry{}); }

  // The counts of an unordered pair of labels; null when the table is full.
  Count* of(std::uint16_t a, std::uint16_t b) {
    if (a > b) std::swap(a, b);
    std::size_t at = (a * 2654435761U ^ b * 40503U) % kEntries;
    for (std::size_t probe = 0; probe < kEntries; ++probe, at = (at + 1) % kEntries) {
      Entry& entry = entries_[at];
      if (entry.a == 0) entry = {a, b, {}};
      if (entry.a == a && entry.b == b) return &entry.count;
    }
    return nullptr;
  }

  [[nodiscard]] std::span<const Entry> entries() const { return entries_; }

 private:
  static constexpr std::size_t kEntries = 1024;
  std::span<Entry> entries_;
};

// Which labels were joined: each label's lowest partner.
class LabelUnion {
 public:
  explicit LabelUnion(Arena& arena) : parent_(arena.take<std::uint16_t>("segment: borders", 65536)) {}

  void clear() {
    for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = static_cast<std::uint16_t>(i);
  }
  std::uint16_t root(std::uint16_t label) {
    while (parent_[label] != label) label = parent_[label] = parent_[parent_[label]];
    return label;
  }
  void unite(std::uint16_t a, std::uint16_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::span<std::uint16_t> parent_;
};

}  // namespace beltpick::segment
