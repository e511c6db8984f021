// Finds planes, cylinders and spheres among the points of an object or of a part by MSAC (the paper's section 3.2).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/arena.hpp"
#include "base/random.hpp"
#include "base/result.hpp"
#include "base/stages.hpp"
#include "primitives/cloud.hpp"

namespace beltpick::primitives {

struct Model;

// Which side of a curved surface is seen.
enum class Side : std::uint8_t { kEither, kBoss, kBore };

struct PrimitiveQuery {
  PrimitiveKind kind = PrimitiveKind::kCylinder;
  // Standard deviation of a point about the ideal surface: measurement noise and form error together. The constant T of
  // equation (4) follows from it: the squared distance that 99 % of the primitive's own points stay below.
  double sigma_mm = 0.05;
  std::optional<double> radius_mm;  // where it is known
  double radius_min_mm = 2.0;       // where it is not
  double radius_max_mm = 200.0;
  Side side = Side::kEither;
  // False: the points' normals are not used, neither to make hypotheses nor to judge points. Boss or bore is then told
  // by the camera, which is taken to stand at the origin.
  bool use_normals = true;
  double normal_angle_max_rad = 0.35;  // between a point's normal and the primitive's, for the point to belong
  double min_share = 0.05;             // of the points
  double min_arc_rad = 0.7;            // that must be seen of a cylinder, about its axis
  double confidence = 0.999;           // of having drawn one sample of inliers only, at min_share
  int max_trials = 20000;
};

class Finder {
 public:
  // Takes memory for up to `max_points` points.
  Finder(Arena& arena, int max_points);

  // The primitive with the least cost (5), refined on its inliers by least squares. Same points, query and state of
  // `random`: the same bits. Points beyond max_points are left out. Errors: kTooFewPoints; kNothingFound where no
  // primitive holds min_share of the points.
  Result<Primitive> find(std::span<const OrientedPoint> points, const PrimitiveQuery& query, Random& random);

  // One after the other, largest first: the best of `queries`, its points taken away, again. inlier_share is of all
  // points. Returns how many of `out` were written; ends when no query finds its min_share (of all points).
  int find_sequence(std::span<const OrientedPoint> points, std::span<const PrimitiveQuery> queries,
                    std::span<Primitive> out, Random& random);

 private:
  struct Found;
  std::optional<Found> best_of(std::span<const PrimitiveQuery> queries, int all_points, Random& random);
  std::optional<Found> search(const PrimitiveQuery& query, int all_points, Random& random);
  void remove_inliers(const PrimitiveQuery& query, const Model& model);

  Cloud cloud_;
};

}  // namespace beltpick::primitives
