#include "teach/teach.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/template_judge.hpp"
#include "html/page.hpp"
#include "primitives/msac.hpp"
#include "teach/cones.hpp"
#include "teach/default_grasps.hpp"
#include "teach/resting.hpp"
#include "teach/units.hpp"

namespace beltpick::teach {

namespace {

constexpr int kPrimitivePoints = 12000;
constexpr int kMaxPrimitives = 10;
// Of the surface: what holes may hide before it is worth a word.
constexpr double kSeriousHoles = 0.005;
// A modeller's rounding makes a few of these.
constexpr std::size_t kManyBranching = 20;

using html::formatted;

std::vector<OrientedPoint> oriented(const Surface& surface) {
  std::vector<OrientedPoint> points;
  const std::size_t step = std::max<std::size_t>(1, surface.point_mm.size() / kPrimitivePoints);
  // Darts fall at random, so every n-th is an even sample too.
  for (std::size_t i = 0; i < surface.point_mm.size() && points.size() < kPrimitivePoints; i += step) {
    points.push_back({surface.point_mm[i], surface.normal[i]});
  }
  return points;
}

// The corners of faces, where there are not too many to look at; else points of the surface.
std::vector<Vec3f> corners_of(const Mesh& mesh, const Surface& surface) {
  constexpr std::size_t kMost = 60000;
  std::vector<bool> used(mesh.vertex_mm.size(), false);
  for (const auto& face : mesh.face) {
    for (const std::uint32_t index : face) used[index] = true;
  }
  std::vector<Vec3f> corners;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) corners.push_back(mesh.vertex_mm[i]);
  }
  return corners.empty() || corners.size() > kMost ? surface.point_mm : corners;
}

void take_box(PartTemplate& part) {
  Vec3f low = part.point_mm.front();
  Vec3f high = low;
  for (const Vec3f& point : part.point_mm) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  part.box_min_mm = low.cast<double>();
  part.box_max_mm = high.cast<double>();
}

// The box of what is taught: of vertices that faces use, or of a scan's points.
Result<void> check_mesh(const Mesh& mesh, bool scan, double mm_per_unit) {
  Eigen::AlignedBox3f box;
  if (scan) {
    for (const Vec3f& vertex : mesh.vertex_mm) box.extend(vertex);
  } else {
    for (const auto& face : mesh.face) {
      for (const std::uint32_t index : face) box.extend(mesh.vertex_mm[index]);
    }
  }
  if (box.isEmpty()) {
    return failure(ResultCode::kMeshInvalid, "expected faces with an area, found none; export the part's surface");
  }
  return check_size(box.min().cast<double>(), box.max().cast<double>(), mm_per_unit);
}

void warn_of_size(const PartTemplate& part, double mm_per_unit, std::vector<std::string>& warnings) {
  const std::string doubt = doubt_of_size(part.box_max_mm - part.box_min_mm, mm_per_unit);
  if (!doubt.empty()) warnings.push_back(doubt);
}

void warn_of_holes(const MeshRepair& repair, std::vector<std::string>& warnings) {
  if (repair.holes == 0) return;
  if (repair.hole_share < 0.3) {
    warnings.push_back(formatted(
        "the mesh has open edges round %zu places, %.2g %% of its surface: %s", repair.holes, 100 * repair.hole_share,
        repair.hole_share < kSeriousHoles ? "too little to matter"
                                          : "what lies there is not part of the template; close them in CAD"));
  } else {
    warnings.push_back(
        "the surface is open and has no thickness: it can be found from the side that its faces look to; export a "
        "closed body");
  }
}

void warn_of_mesh(const MeshRepair& repair, std::vector<std::string>& warnings) {
  warn_of_holes(repair, warnings);
  if (repair.pieces > 1) {
    warnings.push_back(formatted(
        "the file holds %zu bodies apart from each other: taught as one rigid part; export one", repair.pieces));
  }
  if (repair.specks > 0)
    warnings.push_back(formatted("%zu tiny pieces apart from the part were left out", repair.specks));
  if (repair.branching_edges > kManyBranching) {
    warnings.push_back(
        formatted("%zu edges join more than two faces (walls inside, or bodies that touch): taken as they are",
                  repair.branching_edges));
  }
  if (repair.flipped_faces > 0)
    warnings.push_back(formatted("%zu faces looked inward and were turned", repair.flipped_faces));
  if (repair.duplicate_faces > 0)
    warnings.push_back(formatted("%zu duplicate faces were removed", repair.duplicate_faces));
  if (repair.degenerate_faces > 0)
    warnings.push_back(formatted("%zu faces without area were removed", repair.degenerate_faces));
}

void warn_of_ambiguity(const Taught& taught, std::vector<std::string>& warnings) {
  if (taught.part.symmetry.name != "none") {
    warnings.push_back(formatted("the part has symmetry %s: its poses are known up to that, and reported as ambiguous",
                                 taught.part.symmetry.name.c_str()));
  }
  if (taught.nearest_turn) {
    warnings.push_back(formatted(
        "a turn of %.0f degrees changes only %.1f %% of the surface: where that is not seen, the part is withheld",
        deg_from_rad(taught.nearest_turn->angle_rad), 100 * taught.nearest_turn->differing_share));
  }
}

}  // namespace

std::vector<Primitive> find_primitives(const Surface& surface, std::uint64_t seed) {
  const std::vector<OrientedPoint> points = oriented(surface);
  Vec3f low = points.front().point_mm;
  Vec3f high = low;
  for (const OrientedPoint& point : points) {
    low = low.cwiseMin(point.point_mm);
    high = high.cwiseMax(point.point_mm);
  }
  std::array<primitives::PrimitiveQuery, 3> queries;
  constexpr std::array kKinds{PrimitiveKind::kCylinder, PrimitiveKind::kPlane, PrimitiveKind::kSphere};
  for (std::size_t k = 0; k < queries.size(); ++k) {
    queries[k].kind = kKinds[k];
    // A mesh's facets lie off the true surface by their sag; the sample itself is exact.
    queries[k].sigma_mm = 0.05;
    queries[k].normal_angle_max_rad = rad_from_deg(15);
    queries[k].min_share = 0.02;
    queries[k].radius_min_mm = 1.5;
    queries[k].radius_max_mm = 0.5 * static_cast<double>((high - low).norm());
    queries[k].min_arc_rad = rad_from_deg(60);
  }
  Arena measuring;
  primitives::Finder(measuring, kPrimitivePoints);
  ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  primitives::Finder finder(arena, kPrimitivePoints);
  std::array<Primitive, kMaxPrimitives> found;
  Random random(seed);
  const int count = finder.find_sequence(points, queries, found, random);
  return {found.begin(), found.begin() + count};
}

Result<Taught> teach(Mesh mesh, std::vector<Grasp> grasps, const TeachOptions& options) {
  Taught taught;
  const bool scan = mesh.face.empty();
  if (auto sized = check_mesh(mesh, scan, options.mm_per_unit); !sized) return std::unexpected(sized.error());
  if (!scan) {
    taught.repair = repair(mesh);
    if (auto sized = check_mesh(mesh, scan, options.mm_per_unit); !sized) return std::unexpected(sized.error());
  }
  auto surface =
      scan ? sample_scan(mesh, options.points, options.seed) : sample_mesh(mesh, options.points, options.seed);
  if (!surface) return std::unexpected(surface.error());
  taught.surface = std::move(*surface);
  PartTemplate& part = taught.part;
  part.point_mm = taught.surface.point_mm;
  part.normal = taught.surface.normal;
  part.spacing_mm = taught.surface.spacing_mm;
  take_box(part);
  part.primitives = find_primitives(taught.surface, options.seed);
  const double tolerance_mm = std::max(0.15, 0.2 * part.spacing_mm);
  SymmetryReport symmetry = find_symmetry(taught.surface, part.primitives, tolerance_mm);
  part.symmetry = std::move(symmetry.symmetry);
  taught.nearest_turn = symmetry.nearest_turn;
  taught.symmetry_tolerance_mm = tolerance_mm;
  taught.centre_of_gravity_mm = centre_of_gravity_mm(mesh, taught.surface);
  part.resting = resting_positions(corners_of(mesh, taught.surface), taught.centre_of_gravity_mm, part.symmetry);
  part.cones = find_cones(taught.surface, part.primitives, options.seed);
  taught.worth = rank_primitives(taught.surface, part.resting, part.primitives);
  part.routes = plan_routes(part, taught.worth, part.steps);
  part.grasps =
      grasps.empty() ? default_grasps(taught.surface, part.primitives, options.opening_max_mm) : std::move(grasps);
  warn_of_size(part, options.mm_per_unit, taught.warnings);
  if (!scan) warn_of_mesh(taught.repair, taught.warnings);
  warn_of_ambiguity(taught, taught.warnings);
  if (part.grasps.empty()) {
    taught.warnings.push_back(
        formatted("no place narrower than %.0f mm to grip was found: give --grasps", options.opening_max_mm));
  }
  // What is written must be what the appliance takes.
  if (auto judged = contract_io::judge_template(part, "the template"); !judged) {
    return std::unexpected(judged.error());
  }
  return taught;
}

}  // namespace beltpick::teach
