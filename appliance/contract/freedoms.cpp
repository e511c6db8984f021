#include "contract/freedoms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <Eigen/Eigenvalues>

#include "base/units.hpp"

namespace beltpick {
namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr double kHeld_rad = rad_from_deg(0.1);
constexpr double kHeld_mm = 0.1;

// Standard deviation of an angle evenly spread over a whole turn.
const double kAnyTurn_rad = 2.0 * kPi / std::sqrt(12.0);

Mat3 cross(const Vec3& v) {
  Mat3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

bool is_sphere(const Symmetry& symmetry) { return symmetry.name == "sphere"; }

// "the part's x axis", or the direction in numbers.
std::string direction_words(const Vec3& direction, const Symmetry& symmetry) {
  constexpr double kAlong = 0.98;
  if (symmetry.revolution && std::abs(direction.dot(symmetry.axis_direction)) > kAlong) {
    return "the part's axis of symmetry";
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) > kAlong) return std::string("the part's ") + "xyz"[axis] + " axis";
  }
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "the part's direction (%.2f, %.2f, %.2f)", direction.x(), direction.y(),
                direction.z());
  return text.data();
}

std::string words_of(const Freedom& freedom, const Vec3& centre_mm, const Symmetry& symmetry) {
  std::string words = freedom.turn ? "turn about " : "slide along ";
  words += direction_words(freedom.direction_part, symmetry);
  const Vec3 aside = (freedom.through_part_mm - centre_mm).cross(freedom.direction_part);
  if (freedom.turn && aside.norm() > 5.0) {
    std::array<char, 80> text{};
    const Vec3 at = freedom.through_part_mm.array().round() + 0.0;  // which makes -0 a 0
    std::snprintf(text.data(), text.size(), " through (%.0f, %.0f, %.0f) mm", at.x(), at.y(), at.z());
    words += text.data();
  }
  return words;
}

// Turns that the symmetry leaves free, as columns: directions in the part frame.
std::vector<Vec3> free_turns(const Symmetry& symmetry) {
  if (is_sphere(symmetry)) return {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  if (symmetry.revolution) return {symmetry.axis_direction.normalized()};
  return {};
}

// A motion of the rim, (turn x half the diagonal, slide), of unit length and with this deviation.
Freedom freedom_of(const Vec6& motion, double rim_mm, double half_diagonal_mm, const Vec3& reference_mm) {
  Freedom freedom;
  freedom.rim_mm = rim_mm;
  freedom.turn = motion.head<3>().norm() >= motion.tail<3>().norm();
  const Vec3 along = freedom.turn ? motion.head<3>() : motion.tail<3>();
  freedom.direction_part = along.normalized();
  freedom.sigma = rim_mm * along.norm() / (freedom.turn ? half_diagonal_mm : 1.0);
  freedom.through_part_mm = reference_mm;
  if (freedom.turn) {
    const Vec3 turn = motion.head<3>() / half_diagonal_mm;
    freedom.through_part_mm += turn.cross(Vec3(motion.tail<3>())) / turn.squaredNorm();
  }
  freedom.observable = freedom.sigma < (freedom.turn ? kHeld_rad : kHeld_mm);
  return freedom;
}

}  // namespace

std::vector<Freedom> freedoms_of(const Mat6& covariance, const Pose<frame::Camera, frame::Part>& T_camera_part,
                                 const PartTemplate& part) {
  const Symmetry& symmetry = part.symmetry;
  const Vec3 centre_mm = 0.5 * (part.box_min_mm + part.box_max_mm);
  const double half_diagonal_mm = 0.5 * (part.box_max_mm - part.box_min_mm).norm();
  const std::vector<Vec3> free = free_turns(symmetry);
  // About a point that the free turns leave where it is, in the part's own directions.
  const Vec3 reference_mm = free.empty() ? centre_mm : symmetry.axis_point_mm;
  const Mat3 into_part = T_camera_part.rotation.transpose();
  Mat6 change = Mat6::Zero();
  change.topLeftCorner<3, 3>() = into_part;
  change.bottomRightCorner<3, 3>() = into_part;
  change.bottomLeftCorner<3, 3>() = -cross(reference_mm - centre_mm) * into_part;
  Mat6 held = Mat6::Identity();
  for (const Vec3& axis : free) held.topLeftCorner<3, 3>() -= axis * axis.transpose();
  Mat6 scale = Mat6::Identity();
  scale.topLeftCorner<3, 3>() *= half_diagonal_mm;
  const Mat6 to_rim = scale * held * change;
  const Eigen::SelfAdjointEigenSolver<Mat6> motions(Mat6(to_rim * covariance * to_rim.transpose()));

  std::vector<Freedom> freedoms;
  for (const Vec3& axis : free) {
    Freedom freedom{true, axis, reference_mm, kAnyTurn_rad, kAnyTurn_rad * half_diagonal_mm, false, true, ""};
    freedom.words = is_sphere(symmetry) ? "any turn about the part's centre" : "turn about the part's axis of symmetry";
    freedoms.push_back(std::move(freedom));
  }
  // The free turns were taken out: as many motions have no variance left.
  for (int i = 5; i >= static_cast<int>(free.size()); --i) {
    const double rim_mm = std::sqrt(std::max(0.0, motions.eigenvalues()[i]));
    Freedom freedom = freedom_of(motions.eigenvectors().col(i), rim_mm, half_diagonal_mm, reference_mm);
    freedom.words = words_of(freedom, centre_mm, symmetry);
    freedoms.push_back(std::move(freedom));
  }
  return freedoms;
}

std::vector<std::string> unobservable(const std::vector<Freedom>& freedoms, const Symmetry& symmetry) {
  std::vector<std::string> words;
  for (const Freedom& freedom : freedoms) {
    const bool told = std::find(words.begin(), words.end(), freedom.words) != words.end();
    if (!freedom.observable && !told) words.push_back(freedom.words);
  }
  if (!symmetry.elements.empty() && !is_sphere(symmetry)) {
    words.push_back(symmetry.revolution ? "which end of its axis is which (it looks the same turned over)"
                                        : "which of its " + std::to_string(symmetry.elements.size() + 1) +
                                              " like positions it has (symmetry " + symmetry.name + ")");
  }
  return words;
}

void add_free_turn(Mat6& covariance, const Vec3& axis_point_mm, const Vec3& axis_direction, const Vec3& centre_mm) {
  Vec6 motion;
  motion << axis_direction, axis_direction.cross(centre_mm - axis_point_mm);
  covariance += kAnyTurn_rad * kAnyTurn_rad * motion * motion.transpose();
}

}  // namespace beltpick
