#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "decode/plan_parts.hpp"

namespace beltpick::decode {
namespace {

// Phase noise, in turns, of an ordinary fringe (amplitude 60, noise 1.6 grey levels, 8 steps).
constexpr double kOrdinaryNoiseTurns = 0.002;
// Three standard deviations from the border between two fringe orders, on either side of it.
constexpr double kLeastSeparationTurns = 6.0 * kOrdinaryNoiseTurns;
// Shifts that spread the noise further than this determine the phase on paper only.
constexpr double kMaxNoiseGain = 3.0;

double shift_rad(const FrameSpec& frame) { return frame.offset_rad + 2.0 * kPi * frame.step / frame.steps; }

// Whether the shifts stand a full turn's equal parts from each other, in any order.
bool equally_spaced(std::vector<double> shifts_rad) {
  const double step_rad = 2.0 * kPi / static_cast<double>(shifts_rad.size());
  const double first_rad = shifts_rad.front();
  for (double& shift : shifts_rad)
    shift -= first_rad + 2.0 * kPi * std::floor((shift - first_rad) / (2.0 * kPi) + 1e-9);
  std::sort(shifts_rad.begin(), shifts_rad.end());
  for (std::size_t n = 0; n < shifts_rad.size(); ++n) {
    if (std::abs(shifts_rad[n] - static_cast<double>(n) * step_rad) > 1e-6) return false;
  }
  return true;
}

Result<void> solve_weights(const Sequence& sequence, Axis axis, PhaseFit& fit) {
  // I_n = a + C cos d_n - S sin d_n with C = b cos phi and S = b sin phi.
  Eigen::MatrixX3d model(static_cast<Eigen::Index>(fit.frames.size()), 3);
  std::vector<double> shifts_rad;
  for (Eigen::Index n = 0; n < model.rows(); ++n) {
    const double d = shift_rad(sequence.frames[static_cast<std::size_t>(fit.frames[static_cast<std::size_t>(n)])]);
    model.row(n) << 1.0, std::cos(d), -std::sin(d);
    shifts_rad.push_back(d);
  }
  fit.offset_rad = shifts_rad.front();
  fit.equal_steps = equally_spaced(shifts_rad) ? static_cast<int>(shifts_rad.size()) : 0;
  const Eigen::Matrix3d normal = model.transpose() * model;
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
  if (solver.isInvertible()) {
    const Eigen::Matrix3d covariance = solver.inverse();
    fit.noise_gain = std::sqrt(std::max(covariance(1, 1), covariance(2, 2)));
    const Eigen::MatrixXd weights = covariance * model.transpose();
    for (Eigen::Index n = 0; n < model.rows(); ++n) {
      fit.cosine_weight.push_back(weights(1, n));
      fit.sine_weight.push_back(weights(2, n));
    }
  }
  if (!solver.isInvertible() || fit.noise_gain > kMaxNoiseGain) {
    return failure(ResultCode::kSequenceUndecodable,
                   "%s axis, period %g px: its %zu phase frames do not determine the phase; at least three distinct "
                   "shifts are needed",
                   axis_name(axis), fit.period_px, fit.frames.size());
  }
  return {};
}

Result<void> check_frame(const FrameSpec& frame, int index) {
  if (frame.period_px < 2.0 || frame.steps < 3) {
    return failure(ResultCode::kSequenceUndecodable,
                   "frame %d: a phase frame needs period_px >= 2 and steps >= 3, found %g and %d", index,
                   frame.period_px, frame.steps);
  }
  return {};
}

}  // namespace

const char* axis_name(Axis axis) { return axis == Axis::kColumn ? "column" : "row"; }

Result<std::vector<PhaseFit>> fit_phases(const Sequence& sequence, const ExposureRanks& ranks, int exposure,
                                         Axis axis) {
  std::vector<PhaseFit> fits;
  for (int i = 0; i < static_cast<int>(sequence.frames.size()); ++i) {
    const FrameSpec& frame = sequence.frames[static_cast<std::size_t>(i)];
    if (frame.kind != FrameKind::kPhase || frame.axis != axis || !ranks.belongs(i, exposure)) continue;
    if (auto checked = check_frame(frame, i); !checked) return std::unexpected(checked.error());
    auto fit = std::find_if(fits.begin(), fits.end(), [&](const PhaseFit& f) {
      return std::abs(f.period_px - frame.period_px) < 1e-9 * frame.period_px;
    });
    if (fit == fits.end()) fit = fits.insert(fits.end(), PhaseFit{.period_px = frame.period_px});
    if (!fit->frames.empty() &&
        sequence.frames[static_cast<std::size_t>(fit->frames.front())].exposure_us != frame.exposure_us) {
      return failure(ResultCode::kSequenceUndecodable,
                     "frame %d: the phase frames of one period must share one exposure_us", i);
    }
    fit->frames.push_back(i);
  }
  for (PhaseFit& fit : fits) {
    if (auto solved = solve_weights(sequence, axis, fit); !solved) return std::unexpected(solved.error());
  }
  std::sort(fits.begin(), fits.end(), [](const PhaseFit& a, const PhaseFit& b) { return a.period_px < b.period_px; });
  return fits;
}

bool phases_determine_position(const std::vector<double>& periods_px, double range_px) {
  for (int orders = 1; orders * periods_px.front() < range_px - 1e-6; ++orders) {
    double squared = 0.0;
    for (const double period_px : periods_px) {
      const double turns = orders * periods_px.front() / period_px;
      squared += (turns - std::round(turns)) * (turns - std::round(turns));
    }
    if (squared < kLeastSeparationTurns * kLeastSeparationTurns) return false;
  }
  return true;
}

}  // namespace beltpick::decode
