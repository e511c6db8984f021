#include "primitives/hypothesis.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>

namespace beltpick::primitives {
namespace {

struct Sample {
  Vec3 point_mm;
  Vec3 normal;
};

bool radius_allowed(const PrimitiveQuery& query, double radius_mm) {
  return radius_mm >= query.radius_min_mm && radius_mm <= query.radius_max_mm;
}

bool side_allowed(const PrimitiveQuery& query, double side) {
  return query.side == Side::kEither || (query.side == Side::kBoss) == (side > 0);
}

int draw_index(const Cloud& cloud, Random& random) {
  return static_cast<int>(random.below(static_cast<std::uint32_t>(cloud.count)));
}

// A second point for `first`: half of the time any, else the nearest of eight, which lies on the same primitive more
// often.
int draw_partner(const Cloud& cloud, int first, Random& random) {
  const int tries = random.below(2) == 0 ? 1 : 8;
  int best = -1;
  double best_mm2 = 1e30;
  for (int i = 0; i < tries; ++i) {
    const int candidate = draw_index(cloud, random);
    const double mm2 = (cloud.point(candidate) - cloud.point(first)).squaredNorm();
    if (candidate != first && mm2 < best_mm2) best = candidate, best_mm2 = mm2;
  }
  return best;
}

// The normal of the surface near a point, from its nearest neighbours: for clouds whose normals are not to be used.
// Turned towards the camera at the origin of the unshifted frame.
std::optional<Vec3> local_normal(const Cloud& cloud, int centre) {
  constexpr int kNeighbours = 10;
  std::array<int, kNeighbours> nearest{};
  std::array<double, kNeighbours> distance_mm2{};
  int found = 0;
  for (int i = 0; i < cloud.count; ++i) {
    const double mm2 = (cloud.point(i) - cloud.point(centre)).squaredNorm();
    if (found == kNeighbours && mm2 >= distance_mm2[found - 1]) continue;
    int at = found < kNeighbours ? found++ : found - 1;
    for (; at > 0 && distance_mm2[at - 1] > mm2; --at) {
      distance_mm2[at] = distance_mm2[at - 1], nearest[at] = nearest[at - 1];
    }
    distance_mm2[at] = mm2, nearest[at] = i;
  }
  if (found < kNeighbours) return std::nullopt;
  Vec3 mean_mm = Vec3::Zero();
  for (const int i : nearest) mean_mm += cloud.point(i) / kNeighbours;
  Mat3 scatter = Mat3::Zero();
  for (const int i : nearest) scatter += (cloud.point(i) - mean_mm) * (cloud.point(i) - mean_mm).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter);
  const Vec3 normal = solver.eigenvectors().col(0);
  return normal.dot(cloud.point(centre) + cloud.origin_mm) > 0 ? Vec3(-normal) : normal;
}

std::optional<Sample> oriented(const Cloud& cloud, const PrimitiveQuery& query, int i) {
  if (query.use_normals) return Sample{cloud.point(i), cloud.normal(i)};
  const auto normal = local_normal(cloud, i);
  if (!normal) return std::nullopt;
  return Sample{cloud.point(i), *normal};
}

std::optional<std::array<Sample, 2>> draw_pair(const Cloud& cloud, const PrimitiveQuery& query, Random& random) {
  const int first = draw_index(cloud, random);
  const int second = draw_partner(cloud, first, random);
  if (second < 0) return std::nullopt;
  const auto a = oriented(cloud, query, first);
  if (!a) return std::nullopt;
  const auto b = oriented(cloud, query, second);
  if (!b) return std::nullopt;
  return std::array{*a, *b};
}

std::optional<Model> plane_of(const Cloud& cloud, const PrimitiveQuery& query, Random& random) {
  const int first = draw_index(cloud, random);
  if (query.use_normals) return Model{PrimitiveKind::kPlane, cloud.point(first), cloud.normal(first), 0, 1};
  const Vec3 a = cloud.point(first), b = cloud.point(draw_index(cloud, random)),
             c = cloud.point(draw_index(cloud, random));
  Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (length < 1e-6) return std::nullopt;
  normal /= normal.dot(a + cloud.origin_mm) > 0 ? -length : length;
  return Model{PrimitiveKind::kPlane, a, normal, 0, 1};
}

// Known radius: the paper's equation (3), a_i = p_i - r n_i, for a boss; a bore's axis lies on the normals' side.
std::optional<Model> cylinder_of_radius(const std::array<Sample, 2>& pair, const PrimitiveQuery& query, double side) {
  const double reach_mm = side * *query.radius_mm;
  const Vec3 a1 = pair[0].point_mm - reach_mm * pair[0].normal, a2 = pair[1].point_mm - reach_mm * pair[1].normal;
  const Vec3 axis = a2 - a1;
  const double length_mm = axis.norm();
  if (length_mm < 10 * query.sigma_mm) return std::nullopt;
  const Vec3 direction = axis / length_mm;
  // Both normals must stand on the axis, within what the query grants any point.
  const double slant = std::max(std::abs(pair[0].normal.dot(direction)), std::abs(pair[1].normal.dot(direction)));
  if (slant > std::sin(query.normal_angle_max_rad)) return std::nullopt;
  return Model{PrimitiveKind::kCylinder, a1, direction, *query.radius_mm, side};
}

// Unknown radius: the axis stands on both normals and passes where their lines cross, seen along it.
std::optional<Model> cylinder_of_any_radius(const std::array<Sample, 2>& pair, const PrimitiveQuery& query) {
  const Vec3& n1 = pair[0].normal;
  const Vec3& n2 = pair[1].normal;
  const Vec3 cross = n1.cross(n2);
  const double sine = cross.norm();
  if (sine < 0.1) return std::nullopt;
  const Vec3 direction = cross / sine;
  Vec3 across = pair[1].point_mm - pair[0].point_mm;
  across -= across.dot(direction) * direction;
  // p1 + s n1 = p2 + t n2 in the plane across the axis; a boss has its axis behind both points: s, t < 0.
  const double s = across.cross(n2).dot(direction) / sine;
  const double t = across.cross(n1).dot(direction) / sine;
  if (s * t <= 0) return std::nullopt;
  const double radius_mm = 0.5 * (std::abs(s) + std::abs(t));
  if (!radius_allowed(query, radius_mm) || std::abs(s - t) > 0.5 * radius_mm) return std::nullopt;
  return Model{PrimitiveKind::kCylinder, pair[0].point_mm + s * n1, direction, radius_mm, s < 0 ? 1.0 : -1.0};
}

std::optional<Model> cylinder_of(const Cloud& cloud, const PrimitiveQuery& query, Random& random) {
  const auto pair = draw_pair(cloud, query, random);
  if (!pair) return std::nullopt;
  if (!query.radius_mm) return cylinder_of_any_radius(*pair, query);
  const double side = query.side == Side::kEither ? (random.below(2) == 0 ? 1.0 : -1.0)
                      : query.side == Side::kBoss ? 1
                                                  : -1;
  return cylinder_of_radius(*pair, query, side);
}

std::optional<Model> sphere_of_pair(const Cloud& cloud, const PrimitiveQuery& query, Random& random) {
  const int first = draw_index(cloud, random), second = draw_partner(cloud, first, random);
  if (second < 0) return std::nullopt;
  const Vec3 n1 = cloud.normal(first), n2 = cloud.normal(second), gap_mm = cloud.point(second) - cloud.point(first);
  // |p1 - p2| = radius |n1 - n2| on a sphere, whichever its centre; the sign tells boss from bore.
  const double turn2 = (n2 - n1).squaredNorm();
  if (turn2 < 0.01) return std::nullopt;
  const double signed_mm =
      query.radius_mm ? std::copysign(*query.radius_mm, gap_mm.dot(n2 - n1)) : gap_mm.dot(n2 - n1) / turn2;
  const Vec3 centre_mm = 0.5 * (cloud.point(first) + cloud.point(second) - signed_mm * (n1 + n2));
  return Model{PrimitiveKind::kSphere, centre_mm, Vec3::UnitZ(), std::abs(signed_mm), signed_mm > 0 ? 1.0 : -1.0};
}

std::optional<Model> sphere_of_points(const Cloud& cloud, Random& random) {
  const int first = draw_index(cloud, random);
  const Vec3 origin = cloud.point(first);
  Mat3 rows;
  Vec3 half_squares;
  for (int i = 0; i < 3; ++i) {
    const int other = draw_partner(cloud, first, random);
    if (other < 0) return std::nullopt;
    rows.row(i) = cloud.point(other) - origin;
    half_squares[i] = 0.5 * rows.row(i).squaredNorm();
  }
  if (std::abs(rows.determinant()) < 1e-6) return std::nullopt;
  const Vec3 centre_mm = rows.inverse() * half_squares;
  const Vec3 outward = origin - centre_mm;
  const double side = outward.dot(origin + cloud.origin_mm) < 0 ? 1.0 : -1.0;
  return Model{PrimitiveKind::kSphere, origin + centre_mm, Vec3::UnitZ(), centre_mm.norm(), side};
}

}  // namespace

int sample_size(const PrimitiveQuery& query) {
  if (query.kind == PrimitiveKind::kPlane) return query.use_normals ? 1 : 3;
  if (query.kind == PrimitiveKind::kSphere) return query.use_normals ? 2 : 4;
  return 2;
}

std::optional<Model> draw_hypothesis(const Cloud& cloud, const PrimitiveQuery& query, Random& random) {
  std::optional<Model> model;
  switch (query.kind) {
    case PrimitiveKind::kPlane:
      return plane_of(cloud, query, random);
    case PrimitiveKind::kCylinder:
      model = cylinder_of(cloud, query, random);
      break;
    case PrimitiveKind::kSphere:
      model = query.use_normals ? sphere_of_pair(cloud, query, random) : sphere_of_points(cloud, random);
      break;
  }
  if (!model || !side_allowed(query, model->side)) return std::nullopt;
  if (!query.radius_mm && !radius_allowed(query, model->radius_mm)) return std::nullopt;
  return model;
}

}  // namespace beltpick::primitives
