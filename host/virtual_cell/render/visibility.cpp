// Counts on an ideal, unbounded image of the camera's focal length: a lens model says nothing far outside its image.
#include "virtual_cell/render/visibility.hpp"

#include <Eigen/Geometry>

namespace beltpick::virtual_cell {
namespace {

constexpr int kStridePx = 2;

// The image's border in normalised coordinates as a closed polygon.
std::vector<Eigen::Vector2d> image_outline(const RichLens& camera) {
  constexpr int kSteps = 32;
  const double right = camera.width - 0.5;
  const double bottom = camera.height - 0.5;
  std::vector<Eigen::Vector2d> outline;
  const auto side = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    for (int i = 0; i < kSteps; ++i) {
      const Eigen::Vector2d pixel = from + (to - from) * i / kSteps;
      outline.push_back(camera.ray(pixel).head<2>());
    }
  };
  side({-0.5, -0.5}, {right, -0.5});
  side({right, -0.5}, {right, bottom});
  side({right, bottom}, {-0.5, bottom});
  side({-0.5, bottom}, {-0.5, -0.5});
  return outline;
}

// Even-odd rule.
bool inside(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p) {
  bool odd = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      odd = !odd;
    }
  }
  return odd;
}

Eigen::AlignedBox2d projected_box(const Mesh& mesh, const Pose<frame::Camera, frame::Part>& T_camera_part) {
  Eigen::AlignedBox2d box;
  for (const Vec3f& vertex : mesh.vertex_mm) {
    const Vec3 p = T_camera_part * vertex.cast<double>();
    box.extend(Eigen::Vector2d(p.head<2>() / p.z()));
  }
  return box;
}

}  // namespace

std::vector<double> visible_fractions(const Rig& rig, const RayScene& scene) {
  const std::vector<Eigen::Vector2d> outline = image_outline(rig.camera);
  std::vector<double> fractions;
  for (int i = 0; i < static_cast<int>(scene.instances().size()); ++i) {
    const PartInstance& placed = scene.instances()[i];
    const Eigen::AlignedBox2d box = projected_box(scene.part(placed.part).mesh, placed.T_camera_part);
    const double step = kStridePx / rig.camera.fx_px;
    long alone = 0;
    long seen = 0;
    for (double y = box.min().y(); y <= box.max().y(); y += step) {
      for (double x = box.min().x(); x <= box.max().x(); x += step) {
        const Vec3f ray(static_cast<float>(x), static_cast<float>(y), 1.0F);
        float distance = 0.0F;
        if (!scene.meets(i, ray, distance)) continue;
        ++alone;
        if (inside(outline, {x, y}) && scene.cast(Vec3f::Zero(), ray).instance == i) ++seen;
      }
    }
    fractions.push_back(alone > 0 ? static_cast<double>(seen) / static_cast<double>(alone) : 0.0);
  }
  return fractions;
}

}  // namespace beltpick::virtual_cell
