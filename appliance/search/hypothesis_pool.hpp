// HypothesisPool: keeps the best of many hypotheses in a fixed store, and picks among them those that differ.
#pragma once

#include <cstddef>
#include <span>

#include "base/stages.hpp"
#include "contract/part_model.hpp"

namespace beltpick::search {

class HypothesisPool {
 public:
  // `storage` is the caller's; its size is how many are kept.
  explicit HypothesisPool(std::span<Hypothesis> storage) : kept_(storage) {}

  void clear() { count_ = 0; }
  void offer(const Hypothesis& hypothesis);

  [[nodiscard]] std::size_t size() const { return count_; }
  // What a newcomer must stay below to be kept.
  [[nodiscard]] float bar_mm() const;

  // Writes the best hypotheses to `out`, best first, leaving out those within both tolerances of a better one (modulo
  // the part's symmetry); returns how many. Empties the pool.
  std::size_t take_distinct(const PartModel& model, double translation_mm, double rotation_rad,
                            std::span<Hypothesis> out);

 private:
  std::span<Hypothesis> kept_;
  std::size_t count_ = 0;  // a heap, the worst first
};

}  // namespace beltpick::search
