#include "range/code_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace beltpick::range {
namespace {

// How much the coordinate changes from a pixel to the next.
struct CodeSlope {
  float across = 0.0F, down = 0.0F;
};

// The median of the differences between neighbours, from a histogram: fixed memory, whatever the image.
class SlopeHistogram {
 public:
  void add(float slope_px) {
    const float place = (slope_px + kReachPx) * kBinsAPixel;
    if (!(place >= 0.0F && place < static_cast<float>(bins_.size()))) return;  // NaN beside what is not measured
    ++bins_[static_cast<std::size_t>(place)];
    ++count_;
  }
  [[nodiscard]] float median() const {
    int below = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
      below += bins_[bin];
      if (2 * below > count_) return (static_cast<float>(bin) + 0.5F) / kBinsAPixel - kReachPx;
    }
    return 0.0F;
  }

 private:
  static constexpr float kReachPx = 8.0F;
  static constexpr float kBinsAPixel = 64.0F;
  std::array<int, 1024> bins_{};
  int count_ = 0;
};

CodeSlope median_slope(const ImageView<float>& code_px) {
  SlopeHistogram across;
  SlopeHistogram down;
  for (int r = 0; r + 1 < code_px.rows; ++r) {
    for (int c = 0; c + 1 < code_px.cols; ++c) {
      across.add(code_px(r, c + 1) - code_px(r, c));
      down.add(code_px(r + 1, c) - code_px(r, c));
    }
  }
  return {across.median(), down.median()};
}

}  // namespace

CodeEdges::CodeEdges(Arena& arena, int cols)
    : filter_(arena, cols),
      depth_(arena.take<float>("range scratch", static_cast<std::size_t>(cols))),
      sigma_(arena.take<float>("range scratch", static_cast<std::size_t>(cols))) {}

int CodeEdges::mask(const CodeImage& code) {
  const ImageView<float>& code_px = code.column_px.empty() ? code.row_px : code.column_px;
  const CodeNoise& noise = code.column_px.empty() ? code.row_noise : code.column_noise;
  const CodeSlope slope = median_slope(code_px);
  const float steep = std::max(std::fabs(slope.across), std::fabs(slope.down));
  // The filter takes coordinates for depths, seen by a lens that makes a footprint of the slope.
  const float lift = 1e4F + std::fabs(slope.across) * static_cast<float>(code_px.cols) +
                     std::fabs(slope.down) * static_cast<float>(code_px.rows);
  filter_.begin(code_px.cols, lift / std::max(steep, 0.05F));
  int masked = 0;
  const auto judge = [&](int row, std::span<const std::uint8_t> flies) {
    for (std::size_t c = 0; c < flies.size(); ++c) {
      if (flies[c] == 0) continue;
      code.state(row, static_cast<int>(c)) = PixelState::kEdge;
      ++masked;
    }
  };
  for (int row = 0; row < code_px.rows; ++row) {
    for (int c = 0; c < code_px.cols; ++c) {
      const auto at = static_cast<std::size_t>(c);
      const bool valid = code.state(row, c) == PixelState::kValid && std::isfinite(code_px(row, c));
      const float level = lift - slope.down * static_cast<float>(row) - slope.across * static_cast<float>(c);
      depth_[at] = valid ? level + code_px(row, c) : 0.0F;
      sigma_[at] = noise.sigma_px(code.modulation(row, c), code.texture(row, c));
    }
    judge(row - 1, filter_.push(depth_.data(), sigma_.data(), code.modulation.row(row)));
  }
  judge(code_px.rows - 1, filter_.last());
  return masked;
}

}  // namespace beltpick::range
