#include "teach/basin.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "icp/align.hpp"
#include "pipeline/icp_stages.hpp"
#include "result/scene.hpp"

namespace beltpick::teach {

namespace {

constexpr std::array<double, kBasinLevels> kTurns_deg{4, 8, 12, 16, 22, 30, 40, 55};
constexpr std::array<double, kBasinLevels> kShiftShares{0.01, 0.02, 0.03, 0.045, 0.06, 0.08, 0.11, 0.15};
constexpr double kNearlyAll = 0.9;  // of the starts: the rest is what other poses of the search are for
constexpr int kJointTrials = 8;     // a view
constexpr double kFiner = 0.85;
constexpr double kFinest_rad = rad_from_deg(5.0);
constexpr double kCoarsest_rad = rad_from_deg(30.0);
// Home: nearer than what tells two places apart.
constexpr double kHomeShare = 0.012;
constexpr double kHome_rad = 0.05;

using Offset = Eigen::Matrix<double, 6, 1>;  // rotation vector about the box's centre, translation; part frame

std::vector<OrientedPoint> sample_of(const SimulatedView& view, Random& random) {
  std::vector<OrientedPoint> sample;
  if (view.of_part.empty()) return sample;
  for (std::size_t i = 0; i < pipeline::kCoarseSample; ++i) {
    sample.push_back(view.of_part[random.below(static_cast<std::uint32_t>(view.of_part.size()))]);
  }
  return sample;
}

PartPose displaced(const PartPose& truth, const Offset& offset, const Vec3& centre_mm) {
  const Vec3 turn = offset.head<3>();
  const double angle = turn.norm();
  const Mat3 rotation =
      angle < 1e-12 ? Mat3(Mat3::Identity()) : Mat3(Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix());
  const Pose<frame::Part, frame::Part> motion{rotation, centre_mm + offset.tail<3>() - rotation * centre_mm};
  return truth * motion;
}

class Homing {
 public:
  Homing(const PartModel& model, std::span<const SimulatedView> views) : model_(model), views_(views) {
    const auto coarse = pipeline::coarse_stages(model);
    const auto full = pipeline::full_stages(model, result::surface_tolerance_mm(result::Scene{}, model.spacing_mm));
    stages_ = {coarse[0], coarse[1], full[0], full[1]};
    Random random(1, 6);
    for (const SimulatedView& view : views) samples_.push_back(sample_of(view, random));
  }

  [[nodiscard]] bool comes_home(std::size_t view, const Offset& offset) const {
    const PartPose& truth = views_[view].T_camera_part;
    const Alignment alignment =
        icp::align(samples_[view], model_, displaced(truth, offset, model_.centre_mm), stages_, icp::Noise{});
    const PoseDifference d = difference_modulo_symmetry(alignment.T_camera_part, truth, model_);
    return d.translation_mm < kHomeShare * model_.diagonal_mm && d.rotation_rad < kHome_rad;
  }

  // Views whose surface holds the part in every freedom: in others it slides, whatever the start, until its outline is
  // asked, and no step of a search is fine enough.
  [[nodiscard]] std::vector<std::size_t> telling(const Basin& basin) const {
    std::vector<std::size_t> views;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      bool held = samples_[v].size() == pipeline::kCoarseSample;
      for (std::size_t k = 0; held && k < 12; ++k) {
        Offset offset = Offset::Zero();
        offset[static_cast<Eigen::Index>(k / 2)] =
            (k % 2 == 0 ? 1.0 : -1.0) * (k < 6 ? basin.turn_rad[0] : basin.shift_mm[0]);
        held = comes_home(v, offset);
      }
      if (held) views.push_back(v);
    }
    return views;
  }

 private:
  const PartModel& model_;
  std::span<const SimulatedView> views_;
  std::array<icp::Stage, 4> stages_;  // of the appliance's own search
  std::vector<std::vector<OrientedPoint>> samples_;
};

double start_of(const Basin& basin, std::size_t freedom, std::size_t level) {
  return freedom < 3 ? basin.turn_rad[level] : basin.shift_mm[level];
}

void measure_freedom(Basin& basin, std::size_t freedom, const Homing& homing, const std::vector<std::size_t>& views) {
  bool unbroken = true;
  for (std::size_t level = 0; level < kBasinLevels; ++level) {
    int home = 0;
    for (const std::size_t view : views) {
      for (const double sign : {1.0, -1.0}) {
        Offset offset = Offset::Zero();
        offset[static_cast<Eigen::Index>(freedom)] = sign * start_of(basin, freedom, level);
        home += homing.comes_home(view, offset) ? 1 : 0;
      }
    }
    basin.home[freedom][level] = home / (2.0 * static_cast<double>(views.size()));
    unbroken = unbroken && basin.home[freedom][level] >= kNearlyAll;
    if (unbroken) basin.reach[freedom] = start_of(basin, freedom, level);
  }
}

// Every freedom off at once by up to half a step: the farthest that the nearest pose of the search can be.
double share_home(const SearchSteps& steps, const Homing& homing, const std::vector<std::size_t>& views) {
  Random random(1, 7);
  int home = 0;
  for (const std::size_t view : views) {
    for (int trial = 0; trial < kJointTrials; ++trial) {
      Offset offset;
      for (Eigen::Index k = 0; k < 6; ++k) {
        // Corners of the cell come up as often as its inside.
        const double at = random.below(2) == 0 ? (random.below(2) == 0 ? 1.0 : -1.0) : random.uniform(-1.0, 1.0);
        offset[k] = 0.5 * at * (k < 3 ? steps.turn_rad / std::sqrt(3.0) : steps.shift_mm);
      }
      home += homing.comes_home(view, offset) ? 1 : 0;
    }
  }
  return home / static_cast<double>(kJointTrials * static_cast<int>(views.size()));
}

}  // namespace

Basin measure_basin(const PartModel& model, std::span<const SimulatedView> views) {
  Basin basin;
  for (std::size_t level = 0; level < kBasinLevels; ++level) {
    basin.turn_rad[level] = rad_from_deg(kTurns_deg[level]);
    basin.shift_mm[level] = kShiftShares[level] * model.diagonal_mm;
  }
  const Homing homing(model, views);
  const std::vector<std::size_t> telling = homing.telling(basin);
  basin.views = telling.size();
  if (telling.empty()) return basin;
  for (std::size_t freedom = 0; freedom < 6; ++freedom) measure_freedom(basin, freedom, homing, telling);
  const double turn_rad = 2 * *std::min_element(basin.reach.begin(), basin.reach.begin() + 3);
  const double shift_mm = 2 * *std::min_element(basin.reach.begin() + 3, basin.reach.end());
  basin.steps = {std::clamp(turn_rad, kFinest_rad, kCoarsest_rad), std::max(shift_mm, 2 * basin.shift_mm.front())};
  basin.home_at_steps = share_home(basin.steps, homing, telling);
  while (basin.home_at_steps < kNearlyAll && basin.steps.turn_rad * kFiner >= kFinest_rad) {
    basin.steps.turn_rad *= kFiner;
    basin.steps.shift_mm *= kFiner;
    basin.home_at_steps = share_home(basin.steps, homing, telling);
  }
  return basin;
}

}  // namespace beltpick::teach
