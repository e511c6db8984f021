#include "explain/q_map.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "base/units.hpp"
#include "html/page.hpp"
#include "pipeline/pose_finder.hpp"
#include "search/from_primitive.hpp"
#include "search/views.hpp"

namespace beltpick::explain {
namespace {

using html::formatted;

// More poses than any search tries: none is then pushed out of the pool, and every Q is evaluated to its end.
constexpr std::size_t kMostPoses = 200'000;

struct Place {
  std::size_t panel = 0;
  double x = 0.0, y = 0.0;
};
using Locate = std::function<Place(const Hypothesis&)>;

// The angle of the turn about `axis` (unit) that takes `from` to `rotation`, in degrees, [0, 360).
double turn_deg(const Mat3& from, const Mat3& rotation, const Vec3& axis) {
  const Eigen::AngleAxisd turn(Mat3(rotation * from.transpose()));
  const double angle = deg_from_rad(turn.angle()) * (turn.axis().dot(axis) < 0.0 ? -1.0 : 1.0);
  const double whole = std::fmod(angle + 720.0, 360.0);
  return whole > 359.99 ? 0.0 : whole;
}

// The least Q of each place. Places are told apart to a hundredth.
void fill(QMap& map, std::span<const Hypothesis> tried, const Locate& locate) {
  std::vector<std::map<std::pair<long, long>, QPanel::Cell>> cells(map.panels.size());
  map.best_mm = tried.empty() ? 0.0 : std::numeric_limits<double>::max();
  for (const Hypothesis& hypothesis : tried) {
    const Place place = locate(hypothesis);
    const double q = hypothesis.mean_distance_mm;
    map.best_mm = std::min(map.best_mm, q);
    const std::pair key(std::lround(100.0 * place.x), std::lround(100.0 * place.y));
    const auto [cell, first] = cells[place.panel].try_emplace(key, QPanel::Cell{place.x, place.y, q});
    if (!first) cell->second.mean_distance_mm = std::min(cell->second.mean_distance_mm, q);
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const auto& [key, cell] : cells[i]) map.panels[i].cells.push_back(cell);
  }
  map.tried = static_cast<int>(tried.size());
}

// The distance between neighbouring values of a coordinate.
double step_of(const std::vector<QPanel::Cell>& cells, double QPanel::Cell::*value) {
  std::vector<double> values;
  for (const QPanel::Cell& cell : cells) values.push_back(cell.*value);
  std::sort(values.begin(), values.end());
  double step = std::numeric_limits<double>::max();
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] - values[i - 1] > 0.05) step = std::min(step, values[i] - values[i - 1]);
  }
  return step < std::numeric_limits<double>::max() ? step : 1.0;
}

void measure_steps(QMap& map) {
  for (QPanel& panel : map.panels) {
    panel.x_step = step_of(panel.cells, &QPanel::Cell::x);
    panel.y_step = step_of(panel.cells, &QPanel::Cell::y);
  }
}

QMap cylinder_map(const Primitive& taught, const Primitive& found, std::span<const Hypothesis> tried) {
  QMap map;
  map.about = formatted("cylinder of %.1f mm radius, found with %.1f mm, %.0f mm of it in view", taught.radius_mm,
                        found.radius_mm, found.extent_mm);
  for (const char* flip : {"before flipping the axis", "after flipping the axis"}) {
    map.panels.push_back({flip, "shift along the axis, mm", "turn about the axis, degrees", 1, 1, false, {}});
  }
  const Vec3 axis = found.direction;
  const std::array<Mat3, 2> from{search::rotation_onto(taught.direction, axis, 0.0),
                                 search::rotation_onto(-taught.direction, axis, 0.0)};
  fill(map, tried, [&](const Hypothesis& hypothesis) {
    const auto& pose = hypothesis.T_camera_part;
    const std::size_t flipped = (pose.rotation * taught.direction).dot(axis) < 0.0 ? 1 : 0;
    return Place{flipped, (pose * taught.point_mm - found.point_mm).dot(axis),
                 turn_deg(from[flipped], pose.rotation, axis)};
  });
  return map;
}

QMap plane_map(const Primitive& taught, const Primitive& found, std::span<const Hypothesis> tried, bool by_turn) {
  QMap map;
  map.about = formatted("face with %.0f %% of the part's surface, found on %.0f %% of the object",
                        100.0 * taught.inlier_share, 100.0 * found.inlier_share);
  if (by_turn)
    map.panels.push_back(
        {"best over shifts across", "shift in the face, mm", "turn about its normal, degrees", 1, 1, false, {}});
  else
    map.panels.push_back({"best over turns", "shift in the face, mm", "shift across, mm", 1, 1, false, {}});
  const Vec3 u = found.direction.unitOrthogonal(), v = found.direction.cross(u);
  const Mat3 from = search::rotation_onto(taught.direction, found.direction, 0.0);
  fill(map, tried, [&](const Hypothesis& hypothesis) {
    const auto& pose = hypothesis.T_camera_part;
    const Vec3 shift = pose * taught.point_mm - found.point_mm;
    return Place{0, shift.dot(u), by_turn ? turn_deg(from, pose.rotation, found.direction) : shift.dot(v)};
  });
  return map;
}

// By the direction from which the part is seen; the turn about the line of sight is the other freedom.
QMap direction_map(std::string about, const Vec3& sight, std::span<const Hypothesis> tried) {
  QMap map;
  map.about = std::move(about);
  map.panels.push_back({"best over turns about the line of sight",
                        "line of sight in the part's frame, azimuth in degrees",
                        "its elevation, degrees",
                        1,
                        1,
                        true,
                        {}});
  fill(map, tried, [&](const Hypothesis& hypothesis) {
    const Vec3 seen_along = hypothesis.T_camera_part.rotation.transpose() * sight;
    const bool pole = std::abs(seen_along.z()) > 0.9999;  // which has no azimuth
    return Place{0, pole ? 0.0 : deg_from_rad(std::atan2(seen_along.y(), seen_along.x())),
                 deg_from_rad(std::asin(std::clamp(seen_along.z(), -1.0, 1.0)))};
  });
  return map;
}

QMap primitive_map(const Primitive& taught, const Primitive& found, std::span<const Hypothesis> tried) {
  if (taught.kind == PrimitiveKind::kCylinder) return cylinder_map(taught, found, tried);
  if (taught.kind == PrimitiveKind::kPlane) {
    QMap map = plane_map(taught, found, tried, false);
    map.panels.push_back(std::move(plane_map(taught, found, tried, true).panels.front()));
    return map;
  }
  return direction_map(formatted("sphere of %.1f mm radius", taught.radius_mm), Vec3::UnitZ(), tried);
}

Vec3 sight_of(std::span<const OrientedPoint> sample) {
  Vec3f sum = Vec3f::Zero();
  for (const OrientedPoint& point : sample) sum += point.point_mm;
  return sum.cast<double>().normalized();
}

}  // namespace

std::vector<QMap> q_maps(const SearchStory& search, std::span<const PartModel> models) {
  std::vector<Hypothesis> storage(kMostPoses);
  std::vector<QMap> maps;
  const std::span points(search.sample.data(), std::min(search.sample.size(), pipeline::kSearchSample));
  const search::SearchSample sample(points);
  const auto add = [&](int model_index, const search::HypothesisPool& pool, auto&& make) {
    if (pool.size() == 0) return;
    QMap map = make(std::span<const Hypothesis>(storage).first(pool.size()));
    map.model_index = model_index;
    measure_steps(map);
    maps.push_back(std::move(map));
  };
  for (int i = 0; i < static_cast<int>(models.size()); ++i) {
    const PartModel& model = models[static_cast<std::size_t>(i)];
    const search::SearchInput input{model, sample, static_cast<float>(pipeline::coarse_radius_mm(model))};
    if (search.route == pipeline::Effort::kViews) {
      search::HypothesisPool pool(storage);
      search::search_views(input, pool);
      add(i, pool, [&](auto tried) { return direction_map("every view of the part", sight_of(points), tried); });
    }
    for (const FoundPrimitive& found : search.primitives) {
      for (const Primitive& taught : model.taught()) {
        if (found.model_index != i) continue;
        search::HypothesisPool pool(storage);
        search::search_from_primitive(input, taught, found.primitive, pool);
        add(i, pool, [&](auto tried) { return primitive_map(taught, found.primitive, tried); });
      }
    }
  }
  std::stable_sort(maps.begin(), maps.end(), [](const QMap& a, const QMap& b) { return a.best_mm < b.best_mm; });
  return maps;
}

}  // namespace beltpick::explain
