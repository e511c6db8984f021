#include "virtual_cell/render/resting.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <Eigen/Geometry>

#include "base/units.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr int kDirections = 6000;
constexpr int kNeighbours = 8;
constexpr int kTurns = 180;
constexpr double kSameCosine = 0.9998;  // two minima that rolled into one

// Evenly spread directions (Fibonacci's lattice on the sphere).
std::vector<Vec3> sphere_directions(int count) {
  std::vector<Vec3> directions;
  const double golden = kPi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return directions;
}

// The vertices on which the part can stand, relative to the centre of mass: the farthest in each direction.
std::vector<Vec3> standing_points(const ScenePart& part, const std::vector<Vec3>& directions) {
  std::set<std::size_t> chosen;
  Eigen::Matrix3Xf vertices(3, static_cast<Eigen::Index>(part.mesh.vertex_mm.size()));
  for (std::size_t i = 0; i < part.mesh.vertex_mm.size(); ++i)
    vertices.col(static_cast<Eigen::Index>(i)) = part.mesh.vertex_mm[i];
  for (std::size_t d = 0; d < directions.size(); d += 4) {
    Eigen::Index farthest = 0;
    (directions[d].cast<float>().transpose() * vertices).maxCoeff(&farthest);
    chosen.insert(static_cast<std::size_t>(farthest));
  }
  std::vector<Vec3> points;
  for (const std::size_t i : chosen) points.push_back(part.mesh.vertex_mm[i].cast<double>() - part.centre_of_mass_mm);
  return points;
}

double height(const std::vector<Vec3>& points, const Vec3& down) {
  double most = 0.0;
  for (const Vec3& p : points) most = std::max(most, p.dot(down));
  return most;
}

// Downhill to the exact minimum near a direction, by ever smaller steps. The height has creases (two points on the
// ground), along which only few directions go down: hence so many of them.
Vec3 settle_direction(const std::vector<Vec3>& points, Vec3 down) {
  double step = 0.03;
  double best = height(points, down);
  while (step > 1e-6) {
    bool moved = false;
    const Vec3 u = down.unitOrthogonal();
    const Vec3 v = down.cross(u);
    for (int i = 0; i < kTurns; ++i) {
      const double angle = 2.0 * kPi * i / kTurns;
      const Vec3 candidate = (down + step * (std::cos(angle) * u + std::sin(angle) * v)).normalized();
      const double h = height(points, candidate);
      if (h < best - 1e-12) {
        best = h;
        down = candidate;
        moved = true;
        break;
      }
    }
    if (!moved) step *= 0.5;
  }
  return down;
}

// The exact pose: rolls on all vertices near the ground, which the chosen few stand for only roughly.
Vec3 settle_exactly(const ScenePart& part, const std::vector<Vec3>& points, Vec3 down) {
  constexpr double kNearMm = 2.0;
  down = settle_direction(points, down);
  const double ground = height(points, down);
  std::vector<Vec3> near;
  for (const Vec3f& vertex : part.mesh.vertex_mm) {
    const Vec3 p = vertex.cast<double>() - part.centre_of_mass_mm;
    if (p.dot(down) > ground - kNearMm) near.push_back(p);
  }
  return settle_direction(near, down);
}

// The nearest directions of each; the lattice is even, so distance alone will do.
std::vector<std::vector<int>> neighbours_of(const std::vector<Vec3>& directions) {
  std::vector<std::vector<int>> neighbours(directions.size());
  const double reach = std::cos(2.2 * std::sqrt(4.0 * kPi / static_cast<double>(directions.size())));
  // The lattice runs down in z: those within reach lie within a band of indices.
  const int band = static_cast<int>(std::sin(std::acos(reach)) * static_cast<double>(directions.size()) / 2.0) + 2;
  const int count = static_cast<int>(directions.size());
  for (int i = 0; i < count; ++i) {
    for (int j = std::max(0, i - band); j < std::min(count, i + band + 1); ++j) {
      if (i != j && directions[i].dot(directions[j]) > reach) neighbours[i].push_back(j);
    }
    std::sort(neighbours[i].begin(), neighbours[i].end(),
              [&](int a, int b) { return directions[i].dot(directions[a]) > directions[i].dot(directions[b]); });
    if (neighbours[i].size() > 2 * kNeighbours) neighbours[i].resize(2 * kNeighbours);
  }
  return neighbours;
}

// Watershed: floods the heights from below; basins that meet while one is shallower than the nudge become one. Returns
// for each direction the one at the bottom of its basin.
std::vector<int> basins(const std::vector<double>& heights, const std::vector<std::vector<int>>& neighbours,
                        double nudge_mm) {
  std::vector<int> order(heights.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return heights[a] < heights[b]; });
  std::vector<int> bottom(heights.size(), -1);
  std::vector<int> leads_to(heights.size());
  std::iota(leads_to.begin(), leads_to.end(), 0);
  const auto find = [&](int i) {
    while (leads_to[i] != i) i = leads_to[i];
    return i;
  };
  for (const int i : order) {
    for (const int j : neighbours[i]) {
      if (bottom[j] < 0) continue;
      const int other = find(bottom[j]);
      if (bottom[i] < 0) {
        bottom[i] = other;
        continue;
      }
      const int mine = find(bottom[i]);
      const int higher = heights[mine] > heights[other] ? mine : other;
      if (mine != other && heights[i] - heights[higher] < nudge_mm) leads_to[higher] = higher == mine ? other : mine;
    }
    if (bottom[i] < 0) bottom[i] = i;
  }
  for (int& b : bottom) b = find(b);
  return bottom;
}

}  // namespace

std::vector<RestingPose> resting_poses(const ScenePart& part, double nudge_mm) {
  const std::vector<Vec3> directions = sphere_directions(kDirections);
  const std::vector<Vec3> points = standing_points(part, directions);
  std::vector<double> heights;
  for (const Vec3& down : directions) heights.push_back(height(points, down));
  const std::vector<int> bottom = basins(heights, neighbours_of(directions), nudge_mm);
  std::vector<int> count(directions.size(), 0);
  for (const int b : bottom) ++count[b];
  std::vector<RestingPose> poses;
  std::vector<Vec3> downs;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (count[i] == 0) continue;
    const Vec3 down = settle_exactly(part, points, directions[i]);
    const double weight = static_cast<double>(count[i]) / kDirections;
    const auto same =
        std::find_if(downs.begin(), downs.end(), [&](const Vec3& d) { return d.dot(down) > kSameCosine; });
    if (same != downs.end()) {
      poses[static_cast<std::size_t>(same - downs.begin())].weight += weight;
      continue;
    }
    downs.push_back(down);
    RestingPose& pose = poses.emplace_back();
    pose.R_belt_part = Eigen::Quaterniond::FromTwoVectors(down, -Vec3::UnitZ()).toRotationMatrix();
    pose.weight = weight;
    for (const Vec3f& vertex : part.mesh.vertex_mm) {
      pose.height_mm = std::max(pose.height_mm, down.dot(vertex.cast<double>() - part.centre_of_mass_mm));
    }
  }
  std::sort(poses.begin(), poses.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return poses;
}

}  // namespace beltpick::virtual_cell
