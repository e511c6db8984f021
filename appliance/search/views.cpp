#include "search/views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.hpp"

namespace beltpick::search {
namespace {

// Collects distinct unit vectors.
struct Directions {
  std::array<Vec3, PartModel::kViews> at;
  std::size_t count = 0;

  void add(const Vec3& direction) {
    const Vec3 unit = direction.normalized();
    for (std::size_t i = 0; i < count; ++i) {
      if ((at[i] - unit).norm() < 1e-6) return;
    }
    if (count < at.size()) at[count++] = unit;
  }

  // Halves the edges of a triangle `depth` times.
  void divide(const Vec3& a, const Vec3& b, const Vec3& c, int depth) {
    if (depth == 0) {
      add(a);
      add(b);
      add(c);
      return;
    }
    const Vec3 ab = (a + b).normalized();
    const Vec3 bc = (b + c).normalized();
    const Vec3 ca = (c + a).normalized();
    divide(a, ab, ca, depth - 1);
    divide(ab, b, bc, depth - 1);
    divide(ca, bc, c, depth - 1);
    divide(ab, bc, ca, depth - 1);
  }
};

std::array<Vec3, PartModel::kViews> divided_icosahedron() {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  std::array<Vec3, 12> corners;
  for (int i = 0; i < 4; ++i) {
    const double s = i % 2 == 0 ? 1.0 : -1.0;
    const double t = i < 2 ? g : -g;
    const auto at = static_cast<std::size_t>(3 * i);
    corners[at] = Vec3(0.0, s, t).normalized();
    corners[at + 1] = Vec3(s, t, 0.0).normalized();
    corners[at + 2] = Vec3(t, 0.0, s).normalized();
  }
  // Corners that share an edge have this cosine; three that pairwise do are a face.
  const auto neighbours = [](const Vec3& a, const Vec3& b) { return std::abs(a.dot(b) - 1.0 / std::sqrt(5.0)) < 1e-6; };
  Directions directions;
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        const bool face = neighbours(corners[i], corners[j]) && neighbours(corners[j], corners[k]) &&
                          neighbours(corners[k], corners[i]);
        if (face) directions.divide(corners[i], corners[j], corners[k], 2);
      }
    }
  }
  return directions.at;
}

// A parallel projection of the surface, nearest point first.
class SeenFrom {
 public:
  explicit SeenFrom(const PartModel& model) : model_(model) {
    // Cells a little wider than the points lie apart, so that the far side does not shine through.
    pitch_mm_ = std::max(1.6 * static_cast<double>(model.spacing_mm), 1.05 * model.diagonal_mm / kSide);
  }

  PartView look(const Vec3& direction) {
    depth_.fill(std::numeric_limits<float>::max());
    const Vec3 u = direction.unitOrthogonal();
    const Vec3 v = direction.cross(u);
    for (std::size_t i = 0; i < model_.surface.size(); ++i) {
      const OrientedPoint& point = model_.surface[i];
      const Vec3 from_centre = point.point_mm.cast<double>() - model_.centre_mm;
      const int x = static_cast<int>(u.dot(from_centre) / pitch_mm_ + kSide / 2.0);
      const int y = static_cast<int>(v.dot(from_centre) / pitch_mm_ + kSide / 2.0);
      if (x < 0 || y < 0 || x >= kSide || y >= kSide) continue;
      const auto cell = static_cast<std::size_t>(y * kSide + x);
      const float depth = static_cast<float>(direction.dot(from_centre));
      if (depth < depth_[cell]) {
        depth_[cell] = depth;
        nearest_[cell] = static_cast<std::uint16_t>(i);
      }
    }
    return summary(direction);
  }

 private:
  static constexpr int kSide = 160;

  PartView summary(const Vec3& direction) const {
    Vec3 sum = Vec3::Zero();
    int cells = 0;
    for (std::size_t cell = 0; cell < depth_.size(); ++cell) {
      if (depth_[cell] == std::numeric_limits<float>::max()) continue;
      sum += model_.surface[nearest_[cell]].point_mm.cast<double>();
      ++cells;
    }
    const Vec3 centroid = cells == 0 ? model_.centre_mm : Vec3(sum / cells);
    return {direction.cast<float>(), centroid.cast<float>(), static_cast<float>(cells * pitch_mm_ * pitch_mm_)};
  }

  const PartModel& model_;
  double pitch_mm_;
  std::array<float, static_cast<std::size_t>(kSide) * kSide> depth_{};
  std::array<std::uint16_t, static_cast<std::size_t>(kSide) * kSide> nearest_{};
};

}  // namespace

const std::array<Vec3, PartModel::kViews>& view_directions() {
  static const std::array<Vec3, PartModel::kViews> directions = divided_icosahedron();
  return directions;
}

void compute_views(PartModel& model) {
  SeenFrom seen(model);
  for (std::size_t i = 0; i < model.views.size(); ++i) model.views[i] = seen.look(view_directions()[i]);
}

int search_views(const SearchInput& input, HypothesisPool& pool) {
  const Vec3& centroid = input.sample.centroid_mm();
  const Vec3 sight = centroid.normalized();
  const int turns = turn_count(input.model);
  Trials trials(input, pool);
  for (const PartView& view : input.model.views) {
    for (int turn = 0; turn < turns; ++turn) {
      const Mat3 rotation = rotation_onto(view.direction.cast<double>(), sight, 2.0 * kPi * turn / turns);
      trials.add({rotation, centroid - rotation * view.centroid_mm.cast<double>()});
    }
  }
  return PartModel::kViews * turns;
}

}  // namespace beltpick::search
