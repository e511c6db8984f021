#include "virtual_cell/render/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "virtual_cell/render/settle.hpp"
#include "virtual_cell/render/surface_points.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kFootprintCellMm = 4.0;
constexpr int kPlacementTries = 400;
constexpr int kSceneTries = 12;
constexpr double kLeanDropMm = 1.0;
constexpr double kDropGapMm = 0.2;

using Footprint = std::set<std::pair<int, int>>;

// The cells of the belt under a part.
Footprint footprint(const std::vector<Vec3>& points_part, const BeltPart& placed) {
  Footprint cells;
  for (const Vec3& p : points_part) {
    const Vec3 q = placed.T_belt_part * p;
    cells.emplace(static_cast<int>(std::floor(q.x() / kFootprintCellMm)),
                  static_cast<int>(std::floor(q.y() / kFootprintCellMm)));
  }
  return cells;
}

// Whether two footprints come closer than one cell.
bool overlap(const Footprint& a, const Footprint& b) {
  for (const auto& [x, y] : a) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        if (b.contains({x + dx, y + dy})) return true;
      }
    }
  }
  return false;
}

struct ShareRange {
  double low, high;
};

}  // namespace

struct SceneMaker::State {
  std::span<const ScenePart> parts;
  Rig rig;
  std::vector<std::vector<RestingPose>> resting;
  std::vector<std::vector<Vec3>> points;  // part frame
  Settler settler;
  std::vector<double> reach_mm;             // of each part from its centre of mass
  double half_x_mm = 0.0, half_y_mm = 0.0;  // of the view at the belt

  State(std::span<const ScenePart> parts_, const Rig& rig_) : parts(parts_), rig(rig_), settler(parts_) {
    for (const ScenePart& part : parts) {
      resting.push_back(resting_poses(part));
      points.push_back(surface_points(part, 3.0));
      reach_mm.push_back(0.0);
      for (const Vec3& p : points.back()) {
        reach_mm.back() = std::max(reach_mm.back(), (p - part.centre_of_mass_mm).norm());
      }
    }
    half_x_mm = 0.5 * rig.camera.width / rig.camera.fx_px * rig.T_camera_belt.translation_mm.z();
    half_y_mm = 0.5 * rig.camera.height / rig.camera.fy_px * rig.T_camera_belt.translation_mm.z();
  }

  [[nodiscard]] double share_in_view(const BeltPart& placed) const;
  [[nodiscard]] Mat3 orientation(int part, Lay lay, Random& random) const;
  [[nodiscard]] int choice(int part, Random& random) const;
  [[nodiscard]] bool place_apart(const PartLay& lay, Random& random, Scene& scene) const;
  [[nodiscard]] bool place_dropped(int part, Random& random, Scene& scene) const;
  [[nodiscard]] bool place_leaning(int part, Random& random, Scene& scene) const;
};

// The share of the part's surface points whose pixel lies in the image; hidden ones count as well.
double SceneMaker::State::share_in_view(const BeltPart& placed) const {
  int inside = 0;
  for (const Vec3& p : points[placed.part]) {
    const Eigen::Vector2d pixel = rig.camera.project(rig.T_camera_belt * (placed.T_belt_part * p));
    if (pixel.x() > 4 && pixel.y() > 4 && pixel.x() < rig.camera.width - 5 && pixel.y() < rig.camera.height - 5)
      ++inside;
  }
  return static_cast<double>(inside) / static_cast<double>(points[placed.part].size());
}

int SceneMaker::State::choice(int part, Random& random) const {
  return part == PartLay::kDrawn ? static_cast<int>(random.below(static_cast<std::uint32_t>(parts.size()))) : part;
}

// Any orientation, all as likely (Shoemake's uniform quaternions).
Mat3 any_orientation(Random& random) {
  const double share = random.uniform();
  const double one = random.uniform(0.0, 2.0 * kPi);
  const double two = random.uniform(0.0, 2.0 * kPi);
  const double inner = std::sqrt(1.0 - share);
  const double outer = std::sqrt(share);
  return Eigen::Quaterniond(outer * std::cos(two), inner * std::sin(one), inner * std::cos(one), outer * std::sin(two))
      .toRotationMatrix();
}

// A resting pose fit for the way of laying, turned about the vertical at random.
Mat3 SceneMaker::State::orientation(int part, Lay lay, Random& random) const {
  if (lay == Lay::kPropped) return any_orientation(random);
  const std::vector<RestingPose>& poses = resting[part];
  double lowest = poses.front().height_mm;
  double highest = lowest;
  for (const RestingPose& pose : poses) {
    lowest = std::min(lowest, pose.height_mm);
    highest = std::max(highest, pose.height_mm);
  }
  const double border = lowest + 0.25 * (highest - lowest);
  std::vector<double> weights;
  for (const RestingPose& pose : poses) {
    const bool stands = pose.height_mm > border + 1e-9;
    const bool fits = lay == Lay::kFlat || lay == Lay::kLeaning ? !stands : lay != Lay::kEdge || stands;
    weights.push_back(fits ? pose.weight : 0.0);
  }
  double total = 0.0;
  for (const double w : weights) total += w;
  if (total <= 0.0) weights.assign(1, total = 1.0);  // a part with one way to lie
  double draw = random.uniform() * total;
  std::size_t chosen = 0;
  while (chosen + 1 < weights.size() && (draw -= weights[chosen]) >= 0.0) ++chosen;
  const double turn = random.uniform(0.0, 2.0 * kPi);
  return Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix() * poses[chosen].R_belt_part;
}

// Lays a part where it touches no other. False when there is no room.
bool SceneMaker::State::place_apart(const PartLay& asked, Random& random, Scene& scene) const {
  const Lay lay = asked.lay;
  std::vector<Footprint> taken;
  for (const BeltPart& other : scene) taken.push_back(footprint(points[other.part], other));
  const ShareRange share = lay == Lay::kCut ? ShareRange{0.45, 0.88} : ShareRange{1.0, 1.0};
  for (int attempt = 0; attempt < kPlacementTries; ++attempt) {
    BeltPart placed;
    placed.part = choice(asked.part, random);
    placed.T_belt_part.rotation = orientation(placed.part, lay, random);
    double lowest = 0.0;
    for (const Vec3f& v : parts[placed.part].mesh.vertex_mm) {
      lowest = std::min(lowest, (placed.T_belt_part.rotation * v.cast<double>()).z());
    }
    const Vec3 centre = placed.T_belt_part.rotation * parts[placed.part].centre_of_mass_mm;
    const double reach = lay == Lay::kCut ? 1.1 : 0.9;
    placed.T_belt_part.translation_mm = {reach * random.uniform(-half_x_mm, half_x_mm) - centre.x(),
                                         reach * random.uniform(-half_y_mm, half_y_mm) - centre.y(), -lowest};
    const double seen = share_in_view(placed);
    if (seen < share.low || seen > share.high) continue;
    const Footprint cells = footprint(points[placed.part], placed);
    if (std::any_of(taken.begin(), taken.end(), [&](const Footprint& other) { return overlap(cells, other); }))
      continue;
    scene.push_back(placed);
    return true;
  }
  return false;
}

// Lets a tilted part down partly over one of the others. False when it would lie out of view.
bool SceneMaker::State::place_dropped(int part, Random& random, Scene& scene) const {
  constexpr double kMostTilt = 0.6;
  for (int attempt = 0; attempt < kPlacementTries; ++attempt) {
    const BeltPart& below = scene[random.below(static_cast<std::uint32_t>(scene.size()))];
    BeltPart placed;
    placed.part = choice(part, random);
    const double about = random.uniform(0.0, 2.0 * kPi);
    const Eigen::AngleAxisd tilt(random.uniform(0.0, kMostTilt), Vec3(std::cos(about), std::sin(about), 0.0));
    placed.T_belt_part.rotation = tilt * orientation(placed.part, Lay::kAny, random);
    const double away = random.uniform(0.0, 2.0 * kPi);
    const double distance_mm = random.uniform(0.2, 1.2) * reach_mm[placed.part];
    const Vec3 target = below.T_belt_part * parts[below.part].centre_of_mass_mm;
    const Vec3 centre = placed.T_belt_part.rotation * parts[placed.part].centre_of_mass_mm;
    placed.T_belt_part.translation_mm = target - centre + distance_mm * Vec3(std::cos(away), std::sin(away), 0.0);
    if (share_in_view(placed) < 0.8) continue;
    scene.push_back(placed);
    settler.lower_onto(scene, scene.size() - 1, kDropGapMm);
    return true;
  }
  return false;
}

// Drops a part partly over the last one and lets all settle. False when it rolls off or out of view.
bool SceneMaker::State::place_leaning(int part, Random& random, Scene& scene) const {
  const BeltPart below = scene.back();
  const Vec3 target = below.T_belt_part * parts[below.part].centre_of_mass_mm;
  for (int attempt = 0; attempt < 6; ++attempt) {
    BeltPart placed;
    placed.part = choice(part, random);
    placed.T_belt_part.rotation = orientation(placed.part, Lay::kLeaning, random);
    const double away = random.uniform(0.0, 2.0 * kPi);
    const double distance_mm = random.uniform(0.35, 0.7) * reach_mm[placed.part];
    const Vec3 centre = placed.T_belt_part.rotation * parts[placed.part].centre_of_mass_mm;
    placed.T_belt_part.translation_mm = target - centre + distance_mm * Vec3(std::cos(away), std::sin(away), 0.0);
    Scene settled = scene;
    settled.push_back(placed);
    if (share_in_view(placed) < 0.9) continue;
    settler.lift_clear(settled, settled.size() - 1, kLeanDropMm);
    if (!settler.settle(settled)) continue;
    if (share_in_view(settled.back()) < 0.93 || share_in_view(settled[settled.size() - 2]) < 0.9) continue;
    if (!settler.touch(settled, settled.size() - 1)) continue;
    scene = settled;
    return true;
  }
  return false;
}

SceneMaker::SceneMaker(std::span<const ScenePart> parts, const Rig& rig)
    : state_(std::make_unique<State>(parts, rig)) {}
SceneMaker::~SceneMaker() = default;

const std::vector<RestingPose>& SceneMaker::resting(int part) const { return state_->resting[part]; }

Scene SceneMaker::make(std::span<const Lay> lays, std::uint64_t seed) const {
  std::vector<PartLay> drawn;
  for (const Lay lay : lays) drawn.push_back({lay});
  return make(drawn, seed);
}

Scene SceneMaker::make(std::span<const PartLay> lays, std::uint64_t seed) const {
  Scene best;
  for (int attempt = 0; attempt < kSceneTries && best.size() < lays.size(); ++attempt) {
    Random random(seed, 100 + static_cast<std::uint64_t>(attempt));
    Scene scene;
    for (const auto& [lay, part] : lays) {
      if (lay == Lay::kLeaning && !scene.empty() && state_->place_leaning(part, random, scene)) continue;
      if (lay == Lay::kDropped && !scene.empty() && state_->place_dropped(part, random, scene)) continue;
      const bool on_others = lay == Lay::kLeaning || lay == Lay::kDropped;
      if (!state_->place_apart({on_others ? Lay::kFlat : lay, part}, random, scene)) break;
    }
    if (scene.size() > best.size() || attempt == 0) best = scene;
  }
  return best;
}

std::vector<Scene> SceneMaker::make_belt(int count, std::uint64_t seed) const {
  Random random(seed, 3);
  std::vector<Scene> belt;
  for (int left = count; left > 0;) {
    std::vector<Lay> lays;
    for (int i = 0; i < std::min(left, 3); ++i) {
      const double draw = random.uniform();
      lays.push_back(draw < 0.62             ? Lay::kAny
                     : draw < 0.72           ? Lay::kEdge
                     : draw < 0.86 || i == 0 ? Lay::kCut
                                             : Lay::kLeaning);
    }
    belt.push_back(make(lays, seed * 7919 + belt.size()));
    left -= std::max<int>(1, static_cast<int>(belt.back().size()));
  }
  return belt;
}

Result<Scene> SceneMaker::make_paper_scene(int number, std::uint64_t seed) const {
  using enum Lay;
  static constexpr std::array<std::array<Lay, 3>, 12> kFigure4{{{kFlat, kFlat, kFlat},
                                                                {kFlat, kFlat, kEdge},
                                                                {kFlat, kFlat, kFlat},
                                                                {kEdge, kFlat, kFlat},
                                                                {kFlat, kFlat, kLeaning},
                                                                {kFlat, kFlat, kFlat},
                                                                {kFlat, kLeaning, kFlat},
                                                                {kFlat, kEdge, kFlat},
                                                                {kFlat, kFlat, kFlat},
                                                                {kCut, kFlat, kFlat},
                                                                {kFlat, kLeaning, kCut},
                                                                {kFlat, kFlat, kCut}}};
  if (number < 1 || number > 12)
    return failure(ResultCode::kValueOutOfRange, "scene paper:%d: expected 1..12, the paper's measurements", number);
  return make(kFigure4[number - 1], seed * 1009 + static_cast<std::uint64_t>(number));
}

}  // namespace beltpick::virtual_cell
