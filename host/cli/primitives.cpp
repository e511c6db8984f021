// beltpick primitives: the planes, cylinders and spheres that each object of a capture or a cloud is made of.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "options.hpp"
#include "pipeline/measured_normals.hpp"
#include "primitives/msac.hpp"
#include "segmented_input.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;
using primitives::PrimitiveQuery;

// In the order of PrimitiveKind.
constexpr std::array<const char*, 3> kKinds = {"plane", "cylinder", "sphere"};
constexpr int kSample = 4000;                     // points of an object to search in
constexpr std::size_t kPrimitivesOfAnObject = 8;  // at most
// Cast and machined surfaces differ from the ideal shape by about this much.
constexpr double kFormError_mm = 0.1;

struct PrimitivesCommand {
  SegmentChoices choices;
  std::string kind;
  double radius_mm = 0.0;  // 0: not known
};

struct ObjectPrimitives {
  Segment segment;
  std::vector<Primitive> found;
};

// Points of the object on a lattice of its pixels, with normals from neighbourhoods as wide as the noise asks for.
std::vector<OrientedPoint> sample(const SegmentedInput& segmented, const segment::Scale& scale, const Segment& s) {
  const RangeImage& range = segmented.input().range();
  const int stride = std::max(1, static_cast<int>(std::sqrt(s.pixels / static_cast<double>(kSample))));
  std::vector<OrientedPoint> points;
  for (int row = s.row_min; row <= s.row_max; row += stride) {
    for (int col = s.col_min; col <= s.col_max; col += stride) {
      if (segmented.objects().labels(row, col) != s.label || !range.valid(row, col)) continue;
      const double z_mm = range.point_mm(row, col).z();
      const double radius_mm = std::max(3.0 * scale.pitch_mm(z_mm), 4.0 * scale.sigma_mm(z_mm));
      const auto normal = pipeline::measured_normal(range, row, col, static_cast<float>(radius_mm));
      if (normal) points.push_back({range.point_mm(row, col), *normal});
    }
  }
  return points;
}

double diagonal_mm(const std::vector<OrientedPoint>& points) {
  Vec3f low = points.front().point_mm, high = low;
  for (const OrientedPoint& p : points) low = low.cwiseMin(p.point_mm), high = high.cwiseMax(p.point_mm);
  return static_cast<double>((high - low).norm());
}

std::vector<PrimitiveQuery> queries_for(const PrimitivesCommand& command, double sigma_mm, double size_mm) {
  std::vector<PrimitiveQuery> queries;
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    if (!command.kind.empty() && command.kind != kKinds[kind]) continue;
    PrimitiveQuery query;
    query.kind = static_cast<PrimitiveKind>(kind);
    query.sigma_mm = sigma_mm;
    query.radius_max_mm = size_mm;
    // What bends by less than the noise over its width is a plane.
    query.radius_min_mm = std::min(10.0 * sigma_mm, size_mm);
    if (command.radius_mm > 0.0 && query.kind != PrimitiveKind::kPlane) query.radius_mm = command.radius_mm;
    queries.push_back(query);
  }
  return queries;
}

std::vector<ObjectPrimitives> find_all(const PrimitivesCommand& command, const SegmentedInput& segmented) {
  Arena measuring;
  const primitives::Finder sizes(measuring, 2 * kSample);
  const ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  primitives::Finder finder(arena, 2 * kSample);

  const segment::Scale scale = segment::measure_scale(segmented.input().range());
  std::vector<ObjectPrimitives> all;
  for (const Segment& s : segmented.objects().segments) {
    all.push_back({s, {}});
    const auto points = sample(segmented, scale, s);
    if (points.empty()) continue;
    const double noise_mm = scale.sigma_mm(static_cast<double>(points[points.size() / 2].point_mm.z()));
    const auto queries = queries_for(command, std::hypot(noise_mm, kFormError_mm), diagonal_mm(points));
    std::array<Primitive, kPrimitivesOfAnObject> found;
    Random random(segmented.input().seed(), s.label);
    const int count = finder.find_sequence(points, queries, found, random);
    all.back().found.assign(found.begin(), found.begin() + count);
  }
  return all;
}

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const Primitive& p) {
  Json json = {{"kind", kKinds[static_cast<std::size_t>(p.kind)]},
               {"point_mm", json_of(p.point_mm)},
               {"inlier_share", p.inlier_share},
               {"rms_mm", p.rms_mm}};
  if (p.kind == PrimitiveKind::kPlane) json["normal"] = json_of(p.direction);
  if (p.kind == PrimitiveKind::kCylinder) {
    json["axis"] = json_of(p.direction);
    json["extent_mm"] = p.extent_mm;
  }
  if (p.kind != PrimitiveKind::kPlane) {
    json["radius_mm"] = p.radius_mm;
    json["concave"] = p.concave;
  }
  return json;
}

Json json_of(const std::vector<ObjectPrimitives>& all, const SegmentedInput& segmented) {
  Json segments = Json::array();
  for (const ObjectPrimitives& object : all) {
    Json found = Json::array();
    for (const Primitive& p : object.found) found.push_back(json_of(p));
    segments.push_back({{"segment", object.segment.label}, {"pixels", object.segment.pixels}, {"primitives", found}});
  }
  return {{"capture", segmented.input().id()}, {"frame", "camera"}, {"segments", segments}};
}

std::string text_of(const std::vector<ObjectPrimitives>& all) {
  std::string text;
  char line[200];
  for (const ObjectPrimitives& object : all) {
    text += "segment " + std::to_string(object.segment.label) + (object.found.empty() ? ": none\n" : ":\n");
    for (const Primitive& p : object.found) {
      std::snprintf(line, sizeof line, "  %s%s at (%.2f, %.2f, %.2f) mm", p.concave ? "concave " : "",
                    kKinds[static_cast<std::size_t>(p.kind)], p.point_mm.x(), p.point_mm.y(), p.point_mm.z());
      text += line;
      if (p.kind != PrimitiveKind::kSphere) {
        std::snprintf(line, sizeof line, " along (%.3f, %.3f, %.3f)", p.direction.x(), p.direction.y(),
                      p.direction.z());
        text += line;
      }
      if (p.kind != PrimitiveKind::kPlane) {
        std::snprintf(line, sizeof line, ", radius %.2f mm", p.radius_mm);
        text += line;
      }
      std::snprintf(line, sizeof line, ", %.0f %% of the object, rms %.3f mm\n", 100.0 * p.inlier_share, p.rms_mm);
      text += line;
    }
  }
  return text.empty() ? "no objects\n" : text;
}

Result<void> run(const PrimitivesCommand& command, Session& session) {
  if (command.radius_mm > 0.0 && command.kind == "plane") {
    return failure(ResultCode::kUsage,
                   "--radius-mm: a plane has none; leave it off, or ask for a cylinder or a sphere");
  }
  const auto segmented = SegmentedInput::make(command.choices, session);
  if (!segmented) return std::unexpected(segmented.error());
  const auto all = find_all(command, **segmented);
  session.answer(json_of(all, **segmented), text_of(all));
  return {};
}

}  // namespace

Run add_primitives(CLI::App& app) {
  const auto command = std::make_shared<PrimitivesCommand>();
  add_segment_choices(app, command->choices);
  app.add_option("--kind", command->kind, "look for this kind only")->check(CLI::IsMember(choices(kKinds)));
  app.add_option("--radius-mm", command->radius_mm, "of cylinders and spheres, where it is known")
      ->check(CLI::PositiveNumber)
      ->type_name("R");
  example(app,
          "  beltpick primitives capture --calibration calibration.json --kind cylinder --radius-mm 19.5 --json\n"
          "  beltpick primitives cloud.npy");
  return [command](Session& session) { return run(*command, session); };
}

}  // namespace beltpick::cli
