#include "decode/order_search.hpp"

#include <algorithm>
#include <cmath>

#include "base/camera_noise.hpp"
#include "decode/finish_kernels.hpp"

namespace beltpick::decode {
namespace {

constexpr float kTurn = 0.15915494309F;
// What the periods may disagree by without noise, in turns: ripple of the projector's gamma on few steps, defocus.
constexpr float kModelErrorTurns = 0.004F;
// The best order must fit within four standard deviations a period, and every other fit worse by five squared.
constexpr float kMaxMisfit = 16.0F;
constexpr float kLeastLead = 25.0F;

// The range in which the pixel lies.
struct Window {
  float first_px, last_px;
};

struct Order {
  float x_px = 0.0F;
  bool safe = false;
};

class OrderSearch {
 public:
  OrderSearch(const FoldPlan& plan, const AxisPlan& axis) : count_(axis.channels.size()) {
    for (std::size_t c = 0; c < count_; ++c) {
      const PhaseChannel& channel = plan.channels[static_cast<std::size_t>(axis.channels[c])];
      period_px_[c] = static_cast<float>(channel.period_px);
      noise_gain_[c] = static_cast<float>(channel.noise_gain);
    }
  }

  [[nodiscard]] float finest_px() const { return period_px_[0]; }

  [[nodiscard]] Order best(const RowScratch& scratch, std::size_t i, Window window) const {
    std::array<float, kMaxPeriods> weight{};
    const float sigma_level = std::sqrt(kCameraNoise.variance(scratch.mean8[i]));
    const auto variance = [&](std::size_t c) {
      const float sigma = kTurn * noise_gain_[c] * sigma_level / std::max(scratch.amplitude8[c][i], 1e-3F);
      return sigma * sigma;
    };
    for (std::size_t c = 1; c < count_; ++c) {
      const float ratio = period_px_[0] / period_px_[c];
      weight[c] = 1.0F / (kModelErrorTurns * kModelErrorTurns + variance(c) + ratio * ratio * variance(0));
    }
    const float wrapped_px = scratch.turn[0][i] * period_px_[0];
    float least = 1e30F;
    float second = 1e30F;
    Order order;
    for (float k = std::ceil((window.first_px - wrapped_px) / period_px_[0]); true; k += 1.0F) {
      const float x_px = wrapped_px + k * period_px_[0];
      if (x_px > window.last_px) break;
      float misfit = 0.0F;
      for (std::size_t c = 1; c < count_; ++c) {
        const float turns = x_px / period_px_[c] - scratch.turn[c][i];
        const float off = turns - std::floor(turns + 0.5F);
        misfit += off * off * weight[c];
      }
      if (misfit < least) {
        second = least;
        least = misfit;
        order.x_px = x_px;
      } else {
        second = std::min(second, misfit);
      }
    }
    order.safe = least <= kMaxMisfit * static_cast<float>(count_) && second - least >= kLeastLead;
    return order;
  }

 private:
  std::size_t count_;
  std::array<float, kMaxPeriods> period_px_{};
  std::array<float, kMaxPeriods> noise_gain_{};
};

}  // namespace

void order_search_row(const FoldPlan& plan, const AxisPlan& axis, const GrayCode* code, RowScratch& scratch, int cols,
                      float* x_px) {
  const OrderSearch search(plan, axis);
  const auto extent_px = static_cast<float>(axis.extent_px);
  const float last_px = std::nextafter(extent_px - 0.5F, 0.0F);
  // Phase noise may put a pixel at the edge just outside.
  constexpr float kSlackPx = 1.0F;
  float reach_px = 0.0F;
  if (code != nullptr) {
    const CellRule rule{.cell_px = static_cast<float>(code->cell_px), .cells = code->cells, .extent_px = extent_px};
    gray_only_row(scratch.cell.data(), scratch.weak.data(), cols, rule, x_px, scratch.order_safe.data());
    reach_px = 0.5F * static_cast<float>(code->cell_px) + 0.25F * search.finest_px();
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(cols); ++i) {
    Window window{-0.5F - kSlackPx, last_px + kSlackPx};
    if (code != nullptr) {
      window.first_px = std::max(window.first_px, x_px[i] - reach_px);
      window.last_px = std::min(window.last_px, x_px[i] + reach_px);
    }
    const Order order = search.best(scratch, i, window);
    const bool safe = order.safe && (code == nullptr || scratch.order_safe[i] != 0);
    x_px[i] = std::clamp(order.x_px, -0.5F, last_px);
    scratch.order_safe[i] = safe ? 1 : 0;
  }
}

}  // namespace beltpick::decode
