#include "decode/ripple.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "decode/gather_rows.hpp"
#include "decode/phase_advance.hpp"

namespace beltpick::decode {
namespace {

using Terms = Eigen::Matrix<double, kRippleTerms, 1>;
using Normal = Eigen::Matrix<double, kRippleTerms, kRippleTerms>;

constexpr int kMostSteps = 6;  // more keep out all harmonics that defocus lets pass
constexpr int kSampledRows = 160;
constexpr int kMostBlocks = 512;
constexpr double kLeastPixels = 3000.0;
constexpr int kLeastTiles = 12;
constexpr double kLeastSigmas = 6.0;
constexpr double kLeastTurns = 5e-5;  // a two-hundredth of what noise does to a pixel
constexpr float kLeastAmplitude8 = 6.0F;
// How much of the mean a gradient and a curvature over the image may be, as far as nothing is measured.
constexpr double kPriorSlope = 0.6;
constexpr double kPriorBend = 0.4;

constexpr int kViewLines = 8;

// Phases of a channel as they lie in the store.
template <class Pixel>
struct Fringe {
  const RowContext& context;
  int channel;

  // The phase in turns; NaN where the fringe is weak.
  [[nodiscard]] double turn(int row, int col) const {
    const Phase phase = phase_at<Pixel>(context, channel, row, col);
    return phase.amplitude8 < kLeastAmplitude8 ? NAN : static_cast<double>(phase.turn);
  }
};

// Of some rows and columns of the image, the most periods along one.
template <class Pixel>
double periods_in_view(const Fringe<Pixel>& fringe, int rows, int cols) {
  double most = 0.0;
  for (int line = 0; line < kViewLines && most < kEvenlySpreadPeriods; ++line) {
    const int row = (2 * line + 1) * rows / (2 * kViewLines);
    const int col = (2 * line + 1) * cols / (2 * kViewLines);
    most = std::max({most, periods_along(cols, [&](int c) { return fringe.turn(row, c); }),
                     periods_along(rows, [&](int r) { return fringe.turn(r, col); })});
  }
  return most;
}

Terms terms_at(double x, double y) {
  Terms terms;
  terms << 1.0, x, y, x * x, x * y, y * y;
  return terms;
}

}  // namespace

RippleMeter::RippleMeter(int steps, double offset_rad, int rows, int cols)
    : steps_(steps), rows_(rows), cols_(cols), row_step_(std::max(1, rows / kSampledRows)), offset_rad_(offset_rad) {}

void RippleMeter::add_row(int row, const float* turn, const float* amplitude8, const std::uint8_t* flags,
                          std::uint8_t saturation_bits) {
  std::array<RippleSums, kMostBlocks> sums;
  const int blocks = std::min(cols_ / kRippleBlock, kMostBlocks);
  ripple_sums_row(turn, amplitude8, flags, saturation_bits, kLeastAmplitude8, steps_, blocks, sums.data());
  Tile* tiles = &tiles_[static_cast<std::size_t>(row * kTileRows / rows_ * kTileCols)];
  for (int b = 0; b < blocks; ++b) {
    const RippleSums& block = sums[static_cast<std::size_t>(b)];
    Tile& tile = tiles[b * kTileCols / blocks];
    tile.count += block.count;
    for (std::size_t m = 0; m < kRippleOrders; ++m) {
      tile.cosine[m] += static_cast<double>(block.cosine[m]);
      tile.sine[m] += static_cast<double>(block.sine[m]);
    }
  }
}

Ripple RippleMeter::fit() const {
  Ripple ripple{.steps = steps_, .offset_turns = static_cast<float>(offset_rad_ / (2.0 * kPi))};
  for (int m = 1; m <= kRippleOrders; ++m) {
    const auto at = static_cast<std::size_t>(m - 1);
    if (!fit_order(m, ripple.amplitude_turns[at], ripple.limit_turns[at])) break;
    ripple.orders = m;
  }
  return ripple;
}

bool RippleMeter::fit_order(int order, std::array<float, kRippleTerms>& amplitude_turns, float& limit_turns) const {
  const auto m = static_cast<std::size_t>(order - 1);
  const double cycles = order * steps_;
  const double turn_cosine = std::cos(cycles * offset_rad_);
  const double turn_sine = std::sin(cycles * offset_rad_);
  double count = 0.0;
  double total = 0.0;
  double scatter = 0.0;  // of the part that no curve explains: the variance of one pixel's share
  int tiles = 0;
  Normal normal = Normal::Zero();
  Terms right = Terms::Zero();
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const Tile& tile = tiles_[t];
    if (tile.count == 0.0) continue;
    const double even = tile.cosine[m] * turn_cosine - tile.sine[m] * turn_sine;
    const double odd = tile.sine[m] * turn_cosine + tile.cosine[m] * turn_sine;
    const double x = (static_cast<double>(t % kTileCols) + 0.5) * 2.0 / kTileCols - 1.0;
    const double y = (static_cast<double>(t / kTileCols) + 0.5) * 2.0 / kTileRows - 1.0;
    const Terms terms = terms_at(x, y);
    normal += tile.count * terms * terms.transpose();
    right += even * terms;
    count += tile.count;
    total += even;
    scatter += odd * odd / tile.count;
    ++tiles;
  }
  if (tiles < kLeastTiles || count < kLeastPixels) return false;
  const double mean = total / count;
  const double variance = scatter / tiles;
  const double to_turns = 1.0 / (kPi * cycles);  // 2 c / (m N), in turns
  if (mean * mean * count < kLeastSigmas * kLeastSigmas * variance || std::abs(mean) * to_turns < kLeastTurns) {
    return false;
  }
  const double slope = variance / (kPriorSlope * mean * kPriorSlope * mean);
  const double bend = variance / (kPriorBend * mean * kPriorBend * mean);
  normal.diagonal() += (Terms() << 0.0, slope, slope, bend, bend, bend).finished();
  const Terms solved = normal.ldlt().solve(right);
  for (std::size_t k = 0; k < kRippleTerms; ++k) {
    amplitude_turns[k] = static_cast<float>(solved[static_cast<Eigen::Index>(k)] * to_turns);
  }
  limit_turns = static_cast<float>(2.0 * mean * to_turns);
  return true;
}

template <class Pixel>
Ripple measure_ripple(const RowContext& context, RowScratch& scratch, int channel) {
  const PhaseChannel& fringes = context.plan->channels[static_cast<std::size_t>(channel)];
  if (fringes.equal_steps == 0 || fringes.equal_steps > kMostSteps) return {};
  if (periods_in_view(Fringe<Pixel>{context, channel}, context.rows, context.cols) < kEvenlySpreadPeriods) return {};
  RippleMeter meter(fringes.equal_steps, fringes.offset_rad, context.rows, context.cols);
  for (int row = 0; row < context.rows; row += meter.row_step()) {
    gather_phase<Pixel>(context, channel, scratch.turn[0], scratch.amplitude8[0], row);
    meter.add_row(row, scratch.turn[0].data(), scratch.amplitude8[0].data(),
                  context.store.row<const std::uint8_t>(context.plan->flags_plane, row), fringes.saturation_bits);
  }
  return meter.fit();
}

template Ripple measure_ripple<std::uint8_t>(const RowContext&, RowScratch&, int);
template Ripple measure_ripple<std::uint16_t>(const RowContext&, RowScratch&, int);

void correct_ripple_row(const Ripple& ripple, int row, int rows, int cols, float* turn) {
  const float y = 2.0F * static_cast<float>(row) / static_cast<float>(std::max(rows - 1, 1)) - 1.0F;
  std::array<RippleRow, kRippleOrders> orders;
  for (int m = 1; m <= ripple.orders; ++m) {
    const auto at = static_cast<std::size_t>(m - 1);
    const auto& a = ripple.amplitude_turns[at];
    const auto cycles = static_cast<float>(m * ripple.steps);
    orders[at] = {.a = a[0] + y * (a[2] + y * a[5]),
                  .b = a[1] + y * a[4],
                  .c = a[3],
                  .low = std::min(0.0F, ripple.limit_turns[at]),
                  .high = std::max(0.0F, ripple.limit_turns[at]),
                  .cycles = cycles,
                  .offset_turns = cycles * ripple.offset_turns};
  }
  correct_ripple(orders, cols, turn);
}

}  // namespace beltpick::decode
