#include "search/hypothesis_pool.hpp"

#include <algorithm>
#include <limits>

#include "contract/pose_difference.hpp"

namespace beltpick::search {
namespace {

bool better(const Hypothesis& a, const Hypothesis& b) { return a.mean_distance_mm < b.mean_distance_mm; }

}  // namespace

float HypothesisPool::bar_mm() const {
  return count_ < kept_.size() ? std::numeric_limits<float>::max() : kept_.front().mean_distance_mm;
}

void HypothesisPool::offer(const Hypothesis& hypothesis) {
  if (hypothesis.mean_distance_mm >= bar_mm()) return;
  const auto first = kept_.begin();
  if (count_ == kept_.size()) std::pop_heap(first, first + static_cast<std::ptrdiff_t>(count_--), better);
  kept_[count_++] = hypothesis;
  std::push_heap(first, first + static_cast<std::ptrdiff_t>(count_), better);
}

std::size_t HypothesisPool::take_distinct(const PartModel& model, double translation_mm, double rotation_rad,
                                          std::span<Hypothesis> out) {
  std::sort_heap(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(count_), better);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < count_ && taken < out.size(); ++i) {
    const auto known = [&](const Hypothesis& earlier) {
      const PoseDifference d = difference_modulo_symmetry(kept_[i].T_camera_part, earlier.T_camera_part, model);
      return d.translation_mm < translation_mm && d.rotation_rad < rotation_rad;
    };
    if (std::none_of(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(taken), known)) out[taken++] = kept_[i];
  }
  count_ = 0;
  return taken;
}

}  // namespace beltpick::search
