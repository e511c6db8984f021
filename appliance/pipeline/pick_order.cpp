#include "pipeline/pick_order.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace beltpick::pipeline {
namespace {

// Parts whose tops differ less lie side by side: their order by height would be noise.
constexpr double kLayer_mm = 10.0;
// Of a part's image, what something in front may hide before it counts as lying under something.
constexpr double kHiddenShare = 0.05;

bool gripped(const LocatedPart& part) { return part.grasp_index >= 0; }

// The smaller, the earlier, within one layer.
auto rank_in_layer(const LocatedPart& part) {
  return std::tuple(part.hidden_share > kHiddenShare, part.touches_neighbour, -part.score);
}

}  // namespace

void order_picks(std::span<const LocatedPart> parts, std::span<std::size_t> order) {
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (auto next = order.begin(); next != order.end(); ++next) {
    const bool any_gripped = std::any_of(next, order.end(), [&](std::size_t i) { return gripped(parts[i]); });
    double top_mm = -std::numeric_limits<double>::max();
    for (auto i = next; i != order.end(); ++i) {
      if (gripped(parts[*i]) == any_gripped) top_mm = std::max(top_mm, parts[*i].top_mm);
    }
    const auto key = [&](std::size_t i) {
      const bool in_turn = gripped(parts[i]) == any_gripped && parts[i].top_mm >= top_mm - kLayer_mm;
      return std::tuple(!in_turn, rank_in_layer(parts[i]), i);
    };
    std::iter_swap(next, std::min_element(next, order.end(), [&](auto a, auto b) { return key(a) < key(b); }));
  }
}

}  // namespace beltpick::pipeline
