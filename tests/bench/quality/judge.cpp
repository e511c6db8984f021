#include "bench/quality/judge.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace beltpick::bench {
namespace {

constexpr int kBandPx = 2;
constexpr float kBandOffMm = 1.0F;
constexpr float kPartOffMm = 0.5F;
constexpr float kSteepest = 5.67F;  // footprints a pixel of a surface at 80 degrees
constexpr float kLeastStepMm = 1.0F;

struct TruthImages {
  ImageView<const Vec3f> point_mm;
  ImageView<const std::uint16_t> instance;
  ImageView<const float> column_px;
  double focal_px;

  // Whether the surface is torn between two neighbouring pixels.
  [[nodiscard]] bool torn(int r0, int c0, int r1, int c1) const {
    const float z0 = point_mm(r0, c0).z();
    const float z1 = point_mm(r1, c1).z();
    const float step_mm = std::max(kLeastStepMm, kSteepest * std::min(z0, z1) / static_cast<float>(focal_px));
    return std::fabs(z0 - z1) > step_mm;
  }
};

void mark_around(std::vector<PixelTruth>& truth, bool PixelTruth::*mark, int rows, int cols, int row, int col) {
  for (int r = std::max(row - kBandPx, 0); r <= std::min(row + kBandPx, rows - 1); ++r) {
    for (int c = std::max(col - kBandPx, 0); c <= std::min(col + kBandPx, cols - 1); ++c) {
      truth[static_cast<std::size_t>(r * cols + c)].*mark = true;
    }
  }
}

void mark_bands(const TruthImages& images, std::vector<PixelTruth>& truth) {
  const int rows = images.point_mm.rows;
  const int cols = images.point_mm.cols;
  const auto lit = [&](int r, int c) { return truth[static_cast<std::size_t>(r * cols + c)].lit; };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      for (const auto& [dr, dc] : {std::pair{0, 1}, std::pair{1, 0}}) {
        if (r + dr >= rows || c + dc >= cols) continue;
        const bool torn = images.torn(r, c, r + dr, c + dc);
        const bool shadow = lit(r, c) != lit(r + dr, c + dc);
        if (torn) {
          mark_around(truth, &PixelTruth::depth_band, rows, cols, r, c);
          mark_around(truth, &PixelTruth::depth_band, rows, cols, r + dr, c + dc);
        }
        if (shadow) {
          mark_around(truth, &PixelTruth::shadow_band, rows, cols, r, c);
          mark_around(truth, &PixelTruth::shadow_band, rows, cols, r + dr, c + dc);
        }
      }
    }
  }
}

// From the truth's neighbouring points; 90 at the border and across tears.
float incidence_deg(const TruthImages& images, const Vec3f& projector_mm, int row, int col) {
  if (row == 0 || col == 0 || row + 1 == images.point_mm.rows || col + 1 == images.point_mm.cols) return 90.0F;
  if (images.torn(row, col - 1, row, col + 1) || images.torn(row - 1, col, row + 1, col)) return 90.0F;
  const Vec3f across = images.point_mm(row, col + 1) - images.point_mm(row, col - 1);
  const Vec3f down = images.point_mm(row + 1, col) - images.point_mm(row - 1, col);
  const Vec3f normal = down.cross(across).normalized();
  const Vec3f point = images.point_mm(row, col);
  const float to_camera = normal.dot(-point.normalized());
  const float to_projector = normal.dot((projector_mm - point).normalized());
  const float least = std::clamp(std::min(to_camera, to_projector), 0.0F, 1.0F);
  return std::acos(least) * static_cast<float>(180.0 / kPi);
}

}  // namespace

std::vector<PixelTruth> truth_of(const VirtualCapture& capture) {
  const auto& renderer = capture.truth();
  const TruthImages images{renderer.true_points_mm(), renderer.true_instances(), renderer.true_column_px(),
                           capture.rig().camera.fx_px};
  const Vec3f projector_mm = capture.rig().T_projector_camera.inverse().translation_mm.cast<float>();
  std::vector<PixelTruth> truth(images.point_mm.size());
  for (int r = 0; r < images.point_mm.rows; ++r) {
    for (int c = 0; c < images.point_mm.cols; ++c) {
      PixelTruth& pixel = truth[static_cast<std::size_t>(r * images.point_mm.cols + c)];
      pixel.part = images.instance(r, c) != 0;
      pixel.lit = renderer.lit(r, c);
      pixel.incidence_deg = incidence_deg(images, projector_mm, r, c);
    }
  }
  mark_bands(images, truth);
  return truth;
}

void Tally::add(const Tally& other) {
  for (const auto member : {&Tally::lit, &Tally::points, &Tally::period_errors, &Tally::part_points,
                            &Tally::part_off_half_mm, &Tally::band_points, &Tally::band_off, &Tally::band_lit,
                            &Tally::eligible, &Tally::complete, &Tally::shadow_points, &Tally::shadow_off}) {
    this->*member += other.*member;
  }
  for (std::size_t s = 0; s < missing.size(); ++s) missing[s] += other.missing[s];
}

Tally judge(const VirtualCapture& capture, const Measurement& measured, const std::vector<PixelTruth>& truth,
            double period_px) {
  const auto points = capture.truth().true_points_mm();
  const auto columns = capture.truth().true_column_px();
  Tally tally;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const PixelTruth& pixel = truth[i];
    const Vec3f& point = measured.range.point_mm.data[i];
    const bool valid = point.z() > 0.0F;
    const float off_mm = valid ? (point - points.data[i]).norm() : 0.0F;
    if (pixel.depth_band) {
      tally.band_lit += pixel.lit ? 1 : 0;
      tally.band_points += valid ? 1 : 0;
      tally.band_off += off_mm > kBandOffMm ? 1 : 0;
      continue;
    }
    tally.lit += pixel.lit ? 1 : 0;
    tally.points += valid ? 1 : 0;
    const float off_px = std::fabs(measured.code.column_px.data[i] - columns.data[i]);
    tally.period_errors += valid && off_px > 0.5 * period_px ? 1 : 0;
    if (pixel.shadow_band) {
      tally.shadow_points += valid ? 1 : 0;
      tally.shadow_off += off_mm > kBandOffMm ? 1 : 0;
      continue;
    }
    if (!pixel.part) continue;
    tally.part_points += valid ? 1 : 0;
    tally.part_off_half_mm += off_mm > kPartOffMm ? 1 : 0;
    if (!pixel.lit || pixel.incidence_deg >= 70.0F) continue;
    ++tally.eligible;
    tally.complete += valid ? 1 : 0;
    if (!valid) ++tally.missing[static_cast<std::size_t>(measured.code.state.data[i])];
  }
  return tally;
}

namespace {

// Errors of the pixels of one tile by their true phase.
class PhaseBins {
 public:
  void add(double phase, double error) {
    const auto bin = std::min(static_cast<std::size_t>(phase * kBins), std::size_t{kBins - 1});
    sum_[bin] += error;
    squares_[bin] += error * error;
    ++count_[bin];
  }
  // Sum over the bins of their squared mean error less that of the tile, and less what the scatter of the errors within
  // a bin lets its mean be off by chance: rounding to grey levels alone scatters by a few hundredths of a pixel.
  void gather(double& squares, int& bins) const {
    double total = 0.0;
    int filled = 0;
    for (std::size_t b = 0; b < kBins; ++b) {
      if (count_[b] < kLeast) continue;
      total += sum_[b] / count_[b];
      ++filled;
    }
    for (std::size_t b = 0; b < kBins; ++b) {
      if (count_[b] < kLeast || filled < kBins) continue;
      const double mean = sum_[b] / count_[b];
      const double off = mean - total / filled;
      const double by_chance = (squares_[b] / count_[b] - mean * mean) / (count_[b] - 1);
      squares += off * off - by_chance;
      ++bins;
    }
  }

 private:
  static constexpr int kBins = 24;
  static constexpr int kLeast = 100;
  std::array<double, kBins> sum_{}, squares_{};
  std::array<int, kBins> count_{};
};

}  // namespace

double ripple_rms_px(const VirtualCapture& capture, const Measurement& measured, const std::vector<PixelTruth>& truth,
                     double period_px) {
  constexpr int kTilePx = 128;
  const auto columns = capture.truth().true_column_px();
  double squares = 0.0;
  int bins = 0;
  for (int top = 0; top < columns.rows; top += kTilePx) {
    for (int left = 0; left < columns.cols; left += kTilePx) {
      PhaseBins tile;
      for (int r = top; r < std::min(top + kTilePx, columns.rows); ++r) {
        for (int c = left; c < std::min(left + kTilePx, columns.cols); ++c) {
          const PixelTruth& pixel = truth[static_cast<std::size_t>(r * columns.cols + c)];
          const bool valid = measured.range.valid(r, c) && !pixel.depth_band && !pixel.shadow_band;
          if (!valid || pixel.incidence_deg > 70.0F) continue;
          const double turns = columns(r, c) / period_px;
          tile.add(turns - std::floor(turns), measured.code.column_px(r, c) - columns(r, c));
        }
      }
      tile.gather(squares, bins);
    }
  }
  return bins == 0 ? 0.0 : std::sqrt(std::max(squares, 0.0) / bins);
}

}  // namespace beltpick::bench
