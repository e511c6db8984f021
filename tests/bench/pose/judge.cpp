#include "bench/pose/judge.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::bench {
namespace {

using result::PartPose;

// The pose of `truth` turned about the model's axis (or centre) so that it comes nearest to `found`.
PartPose turned_towards(const PartPose& found, const PartPose& truth, const PartModel& model) {
  if (!model.revolution && !model.sphere) return truth;
  Mat3 turn = truth.rotation.transpose() * found.rotation;
  if (model.revolution) {
    const Eigen::Quaterniond q(turn);
    const double along = q.vec().dot(model.axis_direction);
    turn = Eigen::AngleAxisd(2.0 * std::atan2(along, q.w()), model.axis_direction).toRotationMatrix();
  }
  const Vec3& centre = model.axis_point_mm;
  return truth * Pose<frame::Part, frame::Part>{turn, centre - turn * centre};
}

GraspError error_at(const PartPose& found, const PartPose& truth, const Vec3& point_mm) {
  return {(found * point_mm - truth * point_mm).norm(),
          deg_from_rad(rotation_between_rad(found.rotation, truth.rotation))};
}

GraspError error_without_symmetry(const PartPose& found, const PartPose& truth, const PartModel& model,
                                  int grasp_index) {
  const PartPose turned = turned_towards(found, truth, model);
  if (model.grasp_count == 0) return error_at(found, turned, model.centre_mm);
  GraspError worst;
  for (int i = 0; i < model.grasp_count; ++i) {
    if (grasp_index >= 0 && i != grasp_index) continue;
    const Vec3& at_mm = model.grasps[static_cast<std::size_t>(i)].T_part_gripper.translation_mm;
    const GraspError error = error_at(found, turned, at_mm);
    if (error.mm >= worst.mm) worst = error;
  }
  return worst;
}

double badness(const GraspError& error) { return std::max(error.mm / kWrongMm, error.deg / kWrongDeg); }

std::string reason_of(const pipeline::Located& located, std::uint16_t segment) {
  if (segment == 0) return "NO_SEGMENT";
  for (const WithheldObject& withheld : located.found.withheld) {
    if (withheld.segment == segment)
      return std::string(stage_name(withheld.stage)) + ":" + std::string(result_code_name(withheld.reason.code));
  }
  return "EXPLAINED_BY_ANOTHER";
}

// Gives a found pose to the part of the truth that it is nearest to, or counts it as false.
void settle(const LocatedPart& found, const SeenScene& seen, const ScenePlan& plan, const PartPool& pool,
            const Machine& machine, SceneFate& fate) {
  const int claimed = plan.loaded[static_cast<std::size_t>(found.template_index)];
  const PartModel& model = machine.pipeline.models()[static_cast<std::size_t>(found.template_index)];
  const Vec3 centre = found.T_camera_part * model.centre_mm;
  GraspError least{1e6, 180.0};
  int same = -1, nearest = -1;
  double nearest_mm = 1e9;
  for (std::size_t i = 0; i < seen.truth.parts.size(); ++i) {
    const PartPose& pose = seen.truth.parts[i].T_camera_part;
    const double apart = (pose * pool.parts[static_cast<std::size_t>(seen.part[i])].centre_of_mass_mm - centre).norm();
    if (apart < nearest_mm) nearest_mm = apart, nearest = static_cast<int>(i);
    if (seen.part[i] != claimed) continue;
    const GraspError error = grasp_error(found.T_camera_part, pose, model, found.grasp_index);
    if (badness(error) < badness(least)) least = error, same = static_cast<int>(i);
  }
  const bool right = same >= 0 && !least.wrong();
  if (right && !fate.parts[static_cast<std::size_t>(same)].found) {
    TruePartFate& part = fate.parts[static_cast<std::size_t>(same)];
    part.found = true, part.error = least, part.surface_mm = found.rms_mm;
    return;
  }
  fate.false_poses.push_back({pool.parts[static_cast<std::size_t>(claimed)].name,
                              nearest < 0 ? "nothing" : seen.truth.parts[static_cast<std::size_t>(nearest)].part, least,
                              found.score, found.coverage, right});
}

}  // namespace

ShownPart shown_part(const SeenScene& seen, const pipeline::Located& located, int i) {
  ShownPart part;
  std::map<std::uint16_t, int> count;
  for (int row = 0; row < seen.instances.rows; ++row) {
    for (int col = 0; col < seen.instances.cols; ++col) {
      if (seen.instances(row, col) != i + 1) continue;
      ++part.pixels;
      part.measured += seen.range.valid(row, col) ? 1 : 0;
      ++count[located.objects.labels(row, col)];
    }
  }
  count.erase(0);
  const auto most = std::max_element(count.begin(), count.end(), [](auto& a, auto& b) { return a.second < b.second; });
  if (most != count.end()) part.segment = most->first;
  return part;
}

GraspError grasp_error(const PartPose& found, const PartPose& truth, const PartModel& model, int grasp_index) {
  GraspError best = error_without_symmetry(found, truth, model, grasp_index);
  for (int i = 0; i < model.symmetry_count; ++i) {
    const PartPose same = truth * model.symmetries[static_cast<std::size_t>(i)];
    const GraspError error = error_without_symmetry(found, same, model, grasp_index);
    if (badness(error) < badness(best)) best = error;
  }
  return best;
}

SceneFate judge(const SeenScene& seen, const ScenePlan& plan, const PartPool& pool, const Machine& machine,
                const pipeline::Located& located) {
  SceneFate fate;
  for (std::size_t i = 0; i < seen.truth.parts.size(); ++i) {
    TruePartFate& part = fate.parts.emplace_back();
    const ShownPart here = shown_part(seen, located, static_cast<int>(i));
    part.part = seen.truth.parts[i].part;
    part.loaded = std::find(plan.loaded.begin(), plan.loaded.end(), seen.part[i]) != plan.loaded.end();
    part.visible = seen.truth.parts[i].visible_fraction;
    part.measured = part.visible * here.measured_share();
    part.why = reason_of(located, here.segment);
  }
  for (const LocatedPart& found : located.found.parts) settle(found, seen, plan, pool, machine, fate);
  for (TruePartFate& part : fate.parts) {
    if (part.found || !part.loaded) part.why.clear();
  }
  for (const LocatedPart& found : located.found.parts) {
    const auto& tried = located.found.tried;
    const auto at = std::find(tried.begin(), tried.end(), found.segment) - tried.begin();
    if (at < static_cast<std::ptrdiff_t>(tried.size()))
      fate.found_object_ms.push_back(located.found.object_ms[static_cast<std::size_t>(at)]);
  }
  fate.fold_ms = machine.measure.timing().fold_ms;
  fate.decode_ms = machine.measure.timing().decode_ms;
  fate.range_ms = machine.measure.timing().range_ms;
  fate.segment_ms = located.segment_ms;
  fate.locate_ms = located.locate_ms;
  return fate;
}

}  // namespace beltpick::bench
