#include "teach/surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/random.hpp"
#include "contract/result_codes.hpp"
#include "teach/neighbours.hpp"

namespace beltpick::teach {

namespace {

// How close two thrown darts may come, as a share of the mean distance. Random packing reaches 0.83; below that a
// bounded number of throws suffices.
constexpr double kDartShare = 0.76;
constexpr std::size_t kThrowsPerPoint = 40;

// Accepts points that keep their distance from those accepted before. The two sides of a thin sheet do not compete.
class Darts {
 public:
  Darts(double distance_mm, Surface& surface) : distance_(static_cast<float>(distance_mm)), surface_(surface) {}

  bool accept(const Vec3f& point, const Vec3f& normal) {
    const Eigen::Vector3i at = (point / distance_).array().floor().cast<int>();
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (crowded(key(at + Eigen::Vector3i(x, y, z)), point, normal)) return false;
        }
      }
    }
    cells_[key(at)].push_back(static_cast<std::uint32_t>(surface_.point_mm.size()));
    surface_.point_mm.push_back(point);
    surface_.normal.push_back(normal);
    return true;
  }

 private:
  static std::uint64_t key(const Eigen::Vector3i& cell) {
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1FFFFFU; };
    return part(cell.x()) | part(cell.y()) << 21U | part(cell.z()) << 42U;
  }

  bool crowded(std::uint64_t cell, const Vec3f& point, const Vec3f& normal) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end()) return false;
    return std::any_of(found->second.begin(), found->second.end(), [&](std::uint32_t i) {
      return (surface_.point_mm[i] - point).squaredNorm() < distance_ * distance_ &&
             surface_.normal[i].dot(normal) > 0.0F;
    });
  }

  float distance_;
  Surface& surface_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

// Running sums of the faces' areas, to draw faces by area.
std::vector<double> cumulative_area(const Mesh& mesh) {
  std::vector<double> sums;
  sums.reserve(mesh.face.size());
  double sum = 0;
  for (const auto& face : mesh.face) {
    const Vec3 a = (mesh.vertex_mm[face[1]] - mesh.vertex_mm[face[0]]).cast<double>();
    const Vec3 b = (mesh.vertex_mm[face[2]] - mesh.vertex_mm[face[0]]).cast<double>();
    sum += 0.5 * a.cross(b).norm();
    sums.push_back(sum);
  }
  return sums;
}

struct Dart {
  Vec3f point;
  Vec3f normal;
};

Dart throw_dart(const Mesh& mesh, const std::vector<double>& area, Random& random) {
  const auto chosen = std::lower_bound(area.begin(), area.end(), random.uniform() * area.back());
  const auto& face = mesh.face[static_cast<std::size_t>(std::min(chosen, area.end() - 1) - area.begin())];
  const double root = std::sqrt(random.uniform());
  const double second = random.uniform();
  const Vec3 a = mesh.vertex_mm[face[0]].cast<double>();
  const Vec3 b = mesh.vertex_mm[face[1]].cast<double>();
  const Vec3 c = mesh.vertex_mm[face[2]].cast<double>();
  const Vec3 point = (1 - root) * a + root * (1 - second) * b + root * second * c;
  return {point.cast<float>(), (b - a).cross(c - a).normalized().cast<float>()};
}

// The normal of the plane through a point's neighbours.
Vec3f fitted_normal(const std::vector<Vec3f>& points, std::span<const Neighbour> near) {
  Vec3f mean = Vec3f::Zero();
  for (const Neighbour& n : near) mean += points[n.index];
  mean /= static_cast<float>(near.size());
  Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
  for (const Neighbour& n : near) spread += (points[n.index] - mean) * (points[n.index] - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(spread).eigenvectors().col(0);
}

std::vector<Vec3f> scan_normals(const Mesh& scan) {
  if (scan.vertex_normal.size() == scan.vertex_mm.size()) return scan.vertex_normal;
  constexpr std::size_t kNear = 16;
  const NeighbourIndex index(scan.vertex_mm);
  Vec3f centre = Vec3f::Zero();
  for (const Vec3f& point : scan.vertex_mm) centre += point / static_cast<float>(scan.vertex_mm.size());
  std::vector<Vec3f> normals;
  std::vector<Neighbour> near(kNear);
  for (const Vec3f& point : scan.vertex_mm) {
    index.nearest(point, near);
    const Vec3f normal = fitted_normal(scan.vertex_mm, near);
    normals.push_back(normal.dot(point - centre) < 0 ? Vec3f(-normal) : normal);
  }
  return normals;
}

double typical_spacing_mm(const std::vector<Vec3f>& points) {
  const NeighbourIndex index(points);
  std::vector<Neighbour> near(2);
  std::vector<double> distances;
  const std::size_t step = std::max<std::size_t>(1, points.size() / 1000);
  for (std::size_t i = 0; i < points.size(); i += step) {
    index.nearest(points[i], near);
    distances.push_back(std::sqrt(static_cast<double>(near[1].squared_mm2)));
  }
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  return distances[distances.size() / 2];
}

}  // namespace

Result<Surface> sample_mesh(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
  const std::vector<double> area = cumulative_area(mesh);
  if (area.empty() || !(area.back() > 0))
    return failure(ResultCode::kMeshInvalid, "expected a surface, found no area; export the mesh again");
  Surface surface;
  surface.area_mm2 = area.back();
  surface.spacing_mm = std::sqrt(area.back() / static_cast<double>(count));
  Darts darts(kDartShare * surface.spacing_mm, surface);
  Random random(seed);
  for (std::size_t i = 0; i < count * kThrowsPerPoint && surface.point_mm.size() < count; ++i) {
    const Dart dart = throw_dart(mesh, area, random);
    darts.accept(dart.point, dart.normal);
  }
  return surface;
}

Result<Surface> sample_scan(const Mesh& scan, std::size_t count, std::uint64_t seed) {
  if (scan.vertex_mm.size() < 100) {
    return failure(ResultCode::kMeshInvalid, "expected a scan of at least 100 points, found %zu; scan the part again",
                   scan.vertex_mm.size());
  }
  const std::vector<Vec3f> normals = scan_normals(scan);
  std::vector<std::size_t> order(scan.vertex_mm.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  Random random(seed);
  for (std::size_t i = order.size() - 1; i > 0; --i)
    std::swap(order[i], order[random.below(static_cast<std::uint32_t>(i + 1))]);
  const double raw_spacing_mm = typical_spacing_mm(scan.vertex_mm);
  // Thin ever more coarsely until the points fit.
  for (double distance_mm = raw_spacing_mm;; distance_mm *= 1.1) {
    Surface surface;
    Darts darts(std::max(distance_mm, 1e-3), surface);
    for (const std::size_t i : order) {
      if (normals[i].squaredNorm() > 0.25F) darts.accept(scan.vertex_mm[i], normals[i].normalized());
    }
    if (surface.point_mm.size() > count) continue;
    surface.spacing_mm = distance_mm / kDartShare;
    surface.area_mm2 = static_cast<double>(surface.point_mm.size()) * surface.spacing_mm * surface.spacing_mm;
    return surface;
  }
}

}  // namespace beltpick::teach
