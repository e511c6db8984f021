#include "unit/decode/oracle.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <vector>

#include "base/units.hpp"

namespace beltpick::testing {
namespace {

struct Pixel {
  const Sequence& sequence;
  const Images& images;
  std::size_t i;

  [[nodiscard]] double level(std::size_t frame) const { return images.frames[frame][i]; }
};

// a, b cos phi, b sin phi of one period.
Eigen::Vector3d fit_fringe(const Pixel& pixel, Axis axis, double period_px) {
  std::vector<std::array<double, 2>> samples;
  for (std::size_t f = 0; f < pixel.sequence.frames.size(); ++f) {
    const FrameSpec& frame = pixel.sequence.frames[f];
    if (frame.kind != FrameKind::kPhase || frame.axis != axis || frame.period_px != period_px) continue;
    samples.push_back({frame.offset_rad + 2.0 * kPi * frame.step / frame.steps, pixel.level(f)});
  }
  Eigen::MatrixXd model(samples.size(), 3);
  Eigen::VectorXd levels(samples.size());
  for (std::size_t n = 0; n < samples.size(); ++n) {
    model.row(static_cast<int>(n)) << 1.0, std::cos(samples[n][0]), -std::sin(samples[n][0]);
    levels[static_cast<int>(n)] = samples[n][1];
  }
  return model.colPivHouseholderQr().solve(levels);
}

std::vector<double> periods_of(const Sequence& sequence, Axis axis) {
  std::map<double, int> periods;
  for (const FrameSpec& frame : sequence.frames) {
    if (frame.kind == FrameKind::kPhase && frame.axis == axis) ++periods[frame.period_px];
  }
  std::vector<double> sorted;
  for (const auto& [period_px, count] : periods) sorted.push_back(period_px);
  return sorted;
}

double mean_of_finest(const Pixel& pixel, Axis axis) {
  auto periods = periods_of(pixel.sequence, axis);
  if (periods.empty()) {
    axis = axis == Axis::kColumn ? Axis::kRow : Axis::kColumn;
    periods = periods_of(pixel.sequence, axis);
  }
  double sum = 0.0;
  int count = 0;
  for (std::size_t f = 0; f < pixel.sequence.frames.size(); ++f) {
    const FrameSpec& frame = pixel.sequence.frames[f];
    if (frame.kind != FrameKind::kPhase || frame.axis != axis || frame.period_px != periods.front()) continue;
    sum += pixel.level(f);
    ++count;
  }
  return sum / count;
}

// Bright or dark, by the inverted twin, else white and black, else the mean of the finest phase frames.
bool is_bright(const Pixel& pixel, std::size_t f) {
  const FrameSpec& frame = pixel.sequence.frames[f];
  std::optional<double> white;
  std::optional<double> black;
  for (std::size_t g = 0; g < pixel.sequence.frames.size(); ++g) {
    const FrameSpec& other = pixel.sequence.frames[g];
    if (other.kind == FrameKind::kGray && other.axis == frame.axis && other.bit == frame.bit &&
        other.cell_px == frame.cell_px && other.inverted != frame.inverted) {
      return pixel.level(f) > pixel.level(g);
    }
    if (other.kind == FrameKind::kWhite) white = pixel.level(g);
    if (other.kind == FrameKind::kBlack) black = pixel.level(g);
  }
  if (white && black) return pixel.level(f) > 0.5 * (*white + *black);
  return pixel.level(f) > mean_of_finest(pixel, frame.axis);
}

// First and last coordinate that the Gray code allows; the whole extent without one.
std::array<double, 2> gray_interval(const Pixel& pixel, Axis axis) {
  const double end_px = pixel.sequence.projector.extent(axis) - 0.5;
  std::map<int, bool> bits;
  double cell_px = 0.0;
  for (std::size_t f = 0; f < pixel.sequence.frames.size(); ++f) {
    const FrameSpec& frame = pixel.sequence.frames[f];
    if (frame.kind != FrameKind::kGray || frame.axis != axis) continue;
    if (frame.inverted && bits.contains(frame.bit)) continue;
    bits[frame.bit] = is_bright(pixel, f) != frame.inverted;
    cell_px = frame.cell_px;
  }
  if (bits.empty()) return {-0.5, end_px};
  const int lowest = bits.begin()->first;
  int cell = 0;
  bool above = false;
  for (auto bit = bits.rbegin(); bit != bits.rend(); ++bit) {
    above = above != bit->second;
    cell = 2 * cell + (above ? 1 : 0);
  }
  cell_px = std::ldexp(cell_px, lowest);
  return {cell * cell_px - 0.5, std::min((cell + 1) * cell_px - 0.5, end_px)};
}

}  // namespace

double oracle_amplitude(const Sequence& sequence, const Images& images, Axis axis, std::size_t i) {
  return fit_fringe({sequence, images, i}, axis, periods_of(sequence, axis).front()).tail<2>().norm();
}

double oracle_coordinate(const Sequence& sequence, const Images& images, Axis axis, std::size_t i) {
  const Pixel pixel{sequence, images, i};
  const auto [first_px, end_px] = gray_interval(pixel, axis);
  const double centre_px = 0.5 * (first_px + end_px);
  const auto periods = periods_of(sequence, axis);
  if (periods.empty()) return centre_px;
  double best_px = 0.0;
  double least = INFINITY;
  const double finest_px = periods.front();
  const Eigen::Vector3d finest = fit_fringe(pixel, axis, finest_px);
  for (int order = -1; order <= sequence.projector.extent(axis) / finest_px + 1; ++order) {
    const double x_px = (std::atan2(finest[2], finest[1]) / (2.0 * kPi) + order) * finest_px;
    // One period: the order nearest to the Gray cell. Several: the order on which they agree, near the Gray cell.
    double misfit = 0.0;
    for (std::size_t p = 1; p < periods.size(); ++p) {
      const Eigen::Vector3d fringe = fit_fringe(pixel, axis, periods[p]);
      const double turns = x_px / periods[p] - std::atan2(fringe[2], fringe[1]) / (2.0 * kPi);
      misfit += std::pow(turns - std::round(turns), 2);
    }
    const double reach_px = 0.5 * (end_px - first_px) + 0.25 * finest_px;
    if (periods.size() > 1 && std::abs(x_px - centre_px) > reach_px) continue;
    if (periods.size() == 1) misfit = std::abs(x_px - centre_px);
    if (misfit < least) {
      least = misfit;
      best_px = x_px;
    }
  }
  return best_px;
}

}  // namespace beltpick::testing
