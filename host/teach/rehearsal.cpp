#include "teach/rehearsal.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/clock.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "contract/result_codes.hpp"
#include "html/page.hpp"
#include "pipeline/pipeline.hpp"
#include "result/scene.hpp"
#include "teach/demands.hpp"
#include "teach/recognition.hpp"

namespace beltpick::teach {

namespace {

// A pose farther off than this would be a wrong one for a gripper.
constexpr double kWrong_mm = 1.0;
constexpr double kWrong_rad = rad_from_deg(1.0);
constexpr double kSpread_mm = 25.0;  // of the parts about the middle of the view
constexpr std::size_t kBasinViews = 8;
// So many views are looked at again with the part reaching out of the image, with these shares of it inside.
constexpr int kCutViews = 8;
constexpr std::array kCutShares{0.3, 0.45};

// The pipeline in memory of the size that it asks for.
struct Appliance {
  std::unique_ptr<ArenaBlock> block;
  Arena arena;
  std::unique_ptr<pipeline::Pipeline> pipeline;

  Appliance() {
    Limits limits;
    limits.templates = 1;
    Arena measuring;
    const pipeline::Pipeline sizes(measuring, limits);
    block = std::make_unique<ArenaBlock>(measuring.used_bytes());
    arena = Arena(block->data(), block->bytes());
    pipeline = std::make_unique<pipeline::Pipeline>(arena, limits);
  }
};

// Positions in turn, the one that fell most behind its likelihood next.
std::vector<std::size_t> choose_positions(const std::vector<RestingPosition>& resting, int views) {
  std::vector<std::size_t> chosen;
  std::vector<double> given(resting.size(), 0.0);
  for (int i = 0; i < views && !resting.empty(); ++i) {
    std::size_t next = 0;
    for (std::size_t r = 1; r < resting.size(); ++r) {
      if (resting[r].likelihood * (i + 1) - given[r] > resting[next].likelihood * (i + 1) - given[next]) next = r;
    }
    given[next] += 1.0;
    chosen.push_back(next);
  }
  return chosen;
}

Placement placement_of(const RestingPosition& position, int number) {
  Random random(static_cast<std::uint64_t>(number) + 1, 8);
  // Turned by the golden angle from view to view: spread evenly, however many there are.
  return {position.down, number * kPi * (3.0 - std::sqrt(5.0)), random.uniform(-kSpread_mm, kSpread_mm),
          random.uniform(-kSpread_mm, kSpread_mm)};
}

using Error6 = Eigen::Matrix<double, 6, 1>;

Error6 plain_error(const PartPose& found, const PartPose& truth, const PartModel& model) {
  const Pose<frame::Part, frame::Part> apart = truth.inverse() * found;
  const Eigen::AngleAxisd turn(apart.rotation);
  Error6 error;
  error.head<3>() = turn.angle() * turn.axis();
  error.tail<3>() = apart * model.centre_mm - model.centre_mm;
  // What the part's own symmetry leaves open is no error.
  if (model.sphere) error.head<3>().setZero();
  if (model.revolution) error.head<3>() -= error.head<3>().dot(model.axis_direction) * model.axis_direction;
  return error;
}

// The turn about its axis that brings a body of revolution nearest to the truth.
PartPose untwisted(const PartPose& found, const PartPose& truth, const PartModel& model) {
  if (!model.revolution) return found;
  const Eigen::Quaterniond apart(Mat3(found.rotation.transpose() * truth.rotation));
  const double angle = 2 * std::atan2(apart.vec().dot(model.axis_direction), apart.w());
  const Mat3 turn = Eigen::AngleAxisd(angle, model.axis_direction).toRotationMatrix();
  return found * Pose<frame::Part, frame::Part>{turn, model.axis_point_mm - turn * model.axis_point_mm};
}

Error6 error_of(const PartPose& found, const PartPose& truth, const PartModel& model) {
  Error6 best = plain_error(untwisted(found, truth, model), truth, model);
  for (int i = 0; i < model.symmetry_count; ++i) {
    const PartPose other = found * model.symmetries[static_cast<std::size_t>(i)];
    const Error6 error = plain_error(untwisted(other, truth, model), truth, model);
    if (error.head<3>().norm() < best.head<3>().norm()) best = error;
  }
  return best;
}

bool is_wrong(const PoseDifference& d) { return d.translation_mm > kWrong_mm || d.rotation_rad > kWrong_rad; }

void judge(const pipeline::Located& located, const PartModel& model, RehearsedView& view) {
  if (located.found.parts.empty()) {
    if (located.found.withheld.empty()) {
      view.why = "no object was seen";
      return;
    }
    const Error& reason = located.found.withheld.front().reason;
    view.outcome = reason.code == ResultCode::kPoseAmbiguous ? Outcome::kAmbiguous : Outcome::kWithheld;
    view.why = reason.detail;
    return;
  }
  const PartPose& found = located.found.parts.front().T_camera_part;
  const PoseDifference d = difference_modulo_symmetry(found, view.truth, model);
  view.outcome = is_wrong(d) ? Outcome::kWrong : Outcome::kFound;
  view.error = error_of(found, view.truth, model);
  if (view.outcome == Outcome::kWrong) {
    view.why = html::formatted("%.2f mm and %.1f degrees off", d.translation_mm, deg_from_rad(d.rotation_rad));
  }
}

// Notes what the pose shows that was believed in the last view that was located, if any was.
void take_note(const pipeline::Located& located, const PartModel& model, const PartPose& truth, Demands& demands) {
  if (located.found.parts.empty()) return;
  const result::Evidence& evidence = located.found.candidates.front().evidence;
  const PoseDifference d = difference_modulo_symmetry(located.found.parts.front().T_camera_part, truth, model);
  const double tolerance_mm = result::surface_tolerance_mm(result::Scene{}, model.spacing_mm);
  demands.believed(evidence.support, evidence.rms_mm / tolerance_mm, is_wrong(d));
}

Result<RehearsedView> rehearse_one(Appliance& appliance, SimulatedView& simulated, int number, Demands& demands) {
  RehearsedView view;
  view.truth = simulated.T_camera_part;
  pipeline::View input;
  input.range.point_mm = ImageView<Vec3f>(simulated.point_mm.data(), simulated.rows, simulated.cols);
  input.lens = simulated.lens;
  input.projector_mm = simulated.projector_mm;
  input.seed = static_cast<std::uint64_t>(number) + 1;
  const auto located = appliance.pipeline->locate(input);
  if (!located) return std::unexpected(located.error());
  view.locate_ms = located->locate_ms;
  judge(*located, appliance.pipeline->models().front(), view);
  take_note(*located, appliance.pipeline->models().front(), view.truth, demands);
  return view;
}

Result<void> rehearse_cut(Appliance& appliance, SimulatedView& simulated, int number, Demands& demands) {
  for (std::size_t i = 0; i < kCutShares.size(); ++i) {
    pipeline::View input =
        cut(simulated, kCutShares[i], static_cast<CutSide>((static_cast<std::size_t>(number) + 2 * i) % 4));
    input.seed = static_cast<std::uint64_t>(number) + 1;
    const auto located = appliance.pipeline->locate(input);
    if (!located) return std::unexpected(located.error());
    take_note(*located, appliance.pipeline->models().front(), simulated.T_camera_part, demands);
  }
  return {};
}

void sum_up(Rehearsal& rehearsal) {
  std::array<double, 6> squares{};
  std::size_t found = 0;
  std::vector<double> times;
  for (const RehearsedView& view : rehearsal.views) {
    times.push_back(view.locate_ms);
    if (view.outcome != Outcome::kFound) continue;
    ++found;
    for (std::size_t k = 0; k < 6; ++k) {
      const double error = std::abs(view.error[static_cast<Eigen::Index>(k)]);
      squares[k] += error * error;
      rehearsal.worst_error[k] = std::max(rehearsal.worst_error[k], error);
    }
  }
  for (std::size_t k = 0; k < 6 && found > 0; ++k)
    rehearsal.rms_error[k] = std::sqrt(squares[k] / static_cast<double>(found));
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  rehearsal.median_ms = times[times.size() / 2];
  rehearsal.slowest_ms = times.back();
}

void warn(const Rehearsal& rehearsal, const Requirements& required, std::vector<std::string>& warnings) {
  using html::formatted;
  if (rehearsal.cut_wrong > 0) {
    warnings.push_back(
        formatted("where the image ended within the part, %d poses were wrong: of this part at least %.0f %% must be "
                  "measured, of others %.0f",
                  rehearsal.cut_wrong, 100 * required.support, 100 * Requirements{}.support));
  }
  const std::size_t all = rehearsal.views.size();
  if (const std::size_t wrong = rehearsal.count(Outcome::kWrong); wrong > 0) {
    warnings.push_back(
        formatted("in %zu of %zu simulated views a wrong pose was offered: do not use this template before its report "
                  "was looked at",
                  wrong, all));
  }
  if (const std::size_t ambiguous = rehearsal.count(Outcome::kAmbiguous); ambiguous > 0) {
    warnings.push_back(
        formatted("in %zu of %zu simulated views the part's pose was ambiguous and withheld: the report shows which",
                  ambiguous, all));
  }
  if (const std::size_t withheld = rehearsal.count(Outcome::kWithheld); withheld > 0) {
    warnings.push_back(
        formatted("in %zu of %zu simulated views the part was not found: the report shows which", withheld, all));
  }
}

}  // namespace

std::size_t Rehearsal::count(Outcome outcome) const {
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [&](const RehearsedView& view) { return view.outcome == outcome; }));
}

Result<Rehearsal> rehearse(Taught& taught, const Mesh& mesh, int views) {
  Appliance appliance;
  if (auto loaded = appliance.pipeline->load({&taught.part, 1}); !loaded) return std::unexpected(loaded.error());
  Rehearsal rehearsal;
  rehearsal.memory_bytes = appliance.arena.used_bytes();
  const Triangles triangles = triangles_of(mesh, taught.surface);
  const double size_mm = (taught.part.box_max_mm - taught.part.box_min_mm).norm();
  std::vector<SimulatedView> for_basin;
  Demands demands;
  int number = 0;
  for (const std::size_t resting : choose_positions(taught.part.resting, views)) {
    const Placement placement = placement_of(taught.part.resting[resting], number);
    SimulatedView simulated =
        simulate_view(triangles, size_mm, placement, rehearsal.noise_mm, static_cast<std::uint64_t>(number) + 1);
    auto view = rehearse_one(appliance, simulated, number, demands);
    if (!view) return std::unexpected(view.error());
    if (number < kCutViews) {
      if (auto cut = rehearse_cut(appliance, simulated, number, demands); !cut) return std::unexpected(cut.error());
    }
    ++number;
    view->resting = resting;
    view->placement = placement;
    rehearsal.views.push_back(std::move(*view));
    if (for_basin.size() < kBasinViews) for_basin.push_back(std::move(simulated));
  }
  rehearsal.basin = measure_basin(appliance.pipeline->models().front(), for_basin);
  rehearsal.cut_wrong = demands.wrong();
  taught.part.requirements = demands.derived();
  taught.part.steps = rehearsal.basin.steps;
  taught.part.routes = plan_routes(taught.part, taught.worth, taught.part.steps);
  sum_up(rehearsal);
  warn(rehearsal, *taught.part.requirements, taught.warnings);
  return rehearsal;
}

}  // namespace beltpick::teach
