#include "cycle/pick_plan.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"

namespace beltpick::cycle {

void PickPlan::load(std::span<const LocatedPart> parts, int withheld) {
  clear();
  count_ = static_cast<int>(std::min<std::size_t>(parts.size(), kMaxParts));
  withheld_ = withheld + static_cast<int>(parts.size()) - count_;
  for (int i = 0; i < count_; ++i) {
    const bool pickable = parts[i].grasp_index >= 0;
    parts_[i] = pickable ? Part::kPickable : Part::kNone;
    touches_[i] = parts[i].touches_neighbour;
    if (!pickable && without_grasp_++ == 0) {
      const ResultCode told = parts[i].not_offered.code;
      without_grasp_code_ = told == ResultCode::kOk ? ResultCode::kNoGrasp : told;
    }
  }
}

int PickPlan::next() const {
  const auto end = parts_.begin() + count_;
  const auto found = std::find(parts_.begin(), end, Part::kPickable);
  return found == end ? -1 : static_cast<int>(found - parts_.begin());
}

int PickPlan::parts_left() const {
  return static_cast<int>(std::count(parts_.begin(), parts_.begin() + count_, Part::kPickable));
}

void PickPlan::picked(int index) {
  parts_[index] = Part::kGone;
  ++picked_;
  const bool all = touches_[index];
  touched_ = touched_ || all;
  for (int i = 0; i < count_; ++i) {
    if (parts_[i] != Part::kPickable || !(all || touches_[i])) continue;
    parts_[i] = Part::kVoid;
    ++void_;
  }
}

void PickPlan::skipped(int index) { parts_[index] = Part::kSkipped; }

}  // namespace beltpick::cycle
