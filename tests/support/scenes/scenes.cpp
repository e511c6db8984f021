#include "support/scenes/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::test {
namespace {

Pose<frame::Camera, frame::Belt> T_camera_belt() {
  // Belt z up, towards the camera; x to the right.
  const double lean = rad_from_deg(6.0);
  Mat3 rotation;
  rotation.col(0) = Vec3::UnitX();
  rotation.col(2) = Vec3(0.0, std::sin(lean), -std::cos(lean));
  rotation.col(1) = rotation.col(2).cross(rotation.col(0));
  return {rotation, Vec3(0.0, 0.0, 700.0)};
}

// Inverts the lens by fixed-point iteration.
Vec3 sight(const Lens& lens, double col, double row) {
  Vec3 ray((col - lens.cx_px) / lens.fx_px, (row - lens.cy_px) / lens.fy_px, 1.0);
  for (int i = 0; i < 20; ++i) {
    const PixelPosition at = project(lens, ray);
    ray.x() += (col - at.column_px) / lens.fx_px;
    ray.y() += (row - at.row_px) / lens.fy_px;
  }
  return ray.normalized();
}

struct Hit {
  double distance_mm = std::numeric_limits<double>::max();
  int part = -1;  // -1: the belt, or nothing
};

// A part ready to be traced.
struct Traced {
  const Shape* shape;
  Pose<frame::Part, frame::Camera> T_part_camera;
  Vec3 centre_camera_mm;
  double radius_mm;

  explicit Traced(const Placed& placed)
      : shape(placed.shape),
        T_part_camera(placed.T_camera_part.inverse()),
        centre_camera_mm(placed.T_camera_part * Vec3(0.5 * (placed.shape->box_min_mm + placed.shape->box_max_mm))),
        radius_mm(0.5 * (placed.shape->box_max_mm - placed.shape->box_min_mm).norm()) {}

  // Distance along the ray to the surface, or a huge one.
  [[nodiscard]] double trace(const Vec3& origin, const Vec3& direction) const {
    const Vec3 to = centre_camera_mm - origin;
    const double middle = to.dot(direction);
    const double aside2 = to.squaredNorm() - middle * middle;
    if (aside2 > radius_mm * radius_mm) return std::numeric_limits<double>::max();
    const double half = std::sqrt(radius_mm * radius_mm - aside2);
    const Vec3 o = T_part_camera * origin;
    const Vec3 d = T_part_camera.rotation * direction;
    for (double t = std::max(0.0, middle - half); t < middle + half;) {
      const double free = shape->distance(o + t * d);
      if (free < 1e-3) return t;
      t += free;
    }
    return std::numeric_limits<double>::max();
  }
};

Hit first_hit(const std::vector<Traced>& parts, const Vec3& origin, const Vec3& direction, const Plane& belt) {
  Hit hit;
  const double toward = belt.normal.dot(direction);
  if (toward < -1e-6) hit.distance_mm = (belt.offset_mm - belt.normal.dot(origin)) / toward;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double t = parts[i].trace(origin, direction);
    if (t < hit.distance_mm) hit = {t, static_cast<int>(i)};
  }
  return hit;
}

double normal_noise(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(2.0 * kPi * random.uniform());
}

}  // namespace

Vec3 scene_light_mm() { return {-380.0, 20.0, 30.0}; }

Plane scene_belt() {
  const auto T = T_camera_belt();
  Plane plane;
  plane.normal = T.rotation.col(2);
  plane.offset_mm = plane.normal.dot(T.translation_mm);
  return plane;
}

Pose<frame::Camera, frame::Part> on_belt(const Shape& shape, const PartTemplate& part, const Mat3& rotation_belt_part,
                                         double x_mm, double y_mm) {
  double lowest = std::numeric_limits<double>::max();
  for (const Vec3f& p : part.point_mm) lowest = std::min(lowest, (rotation_belt_part * p.cast<double>()).z());
  const Vec3 centre = rotation_belt_part * (0.5 * (shape.box_min_mm + shape.box_max_mm));
  const Pose<frame::Belt, frame::Part> T_belt_part{rotation_belt_part,
                                                   {x_mm - centre.x(), y_mm - centre.y(), -lowest + 0.02}};
  return T_camera_belt() * T_belt_part;
}

Mat3 any_rotation(std::uint64_t seed) {
  Random random(seed, 5);
  const Eigen::Vector4d q(normal_noise(random), normal_noise(random), normal_noise(random), normal_noise(random));
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

void SceneImage::merge(std::uint16_t from, std::uint16_t to) {
  std::replace(label.begin(), label.end(), from, to);
  recount();
}

void SceneImage::recount() {
  segments.clear();
  const int count = *std::max_element(label.begin(), label.end());
  for (int l = 1; l <= count; ++l) {
    Segment s;
    s.label = static_cast<std::uint16_t>(l);
    s.row_min = lens.height, s.row_max = -1, s.col_min = lens.width, s.col_max = -1;
    for (int row = 0; row < lens.height; ++row) {
      for (int col = 0; col < lens.width; ++col) {
        if (labels()(row, col) != l) continue;
        ++s.pixels;
        s.row_min = std::min(s.row_min, row), s.row_max = std::max(s.row_max, row);
        s.col_min = std::min(s.col_min, col), s.col_max = std::max(s.col_max, col);
      }
    }
    if (s.pixels > 0) segments.push_back(s);
  }
}

SceneImage render(const std::vector<Placed>& placed, const SceneOptions& options) {
  SceneImage image;
  const double f = options.focal_px;
  image.lens = {options.width,
                options.height,
                f,
                f * 1.002,
                options.width / 2.0 + 3.0,
                options.height / 2.0 - 2.0,
                {-0.08, 0.03, 0.0004, -0.0003, 0.0}};
  image.belt = scene_belt();
  const auto size = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  image.point_mm.assign(size, Vec3f::Zero());
  image.sigma_mm.assign(size, static_cast<float>(options.noise_mm));
  image.label.assign(size, 0);
  std::vector<Traced> parts;
  for (const Placed& p : placed) parts.emplace_back(p);
  const Vec3 projector = scene_light_mm();
  Random random(options.seed, 9);
  for (int row = 0; row < options.height; ++row) {
    for (int col = 0; col < options.width; ++col) {
      const Vec3 ray = sight(image.lens, col, row);
      const Hit hit = first_hit(parts, Vec3::Zero(), ray, image.belt);
      const double noise = options.noise_mm * normal_noise(random);
      const bool gap = random.uniform() < options.gap_share;
      if (hit.distance_mm > 5000.0 || gap) continue;
      const Vec3 at = hit.distance_mm * ray;
      const auto index =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(col);
      if (options.shadows) {
        const Vec3 from = (at - projector).normalized();
        if (first_hit(parts, projector, from, image.belt).distance_mm < (at - projector).norm() - 0.3) continue;
      }
      image.point_mm[index] = (at + noise * ray).cast<float>();
      image.label[index] = static_cast<std::uint16_t>(hit.part + 1);
    }
  }
  image.recount();
  return image;
}

}  // namespace beltpick::test
