#include "virtual_cell/render/light_map.hpp"

#include <cmath>
#include <functional>
#include <thread>

#include "virtual_cell/render/board_print.hpp"
#include "virtual_cell/render/pattern_light.hpp"
#include "virtual_cell/render/surface.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr int kThreads = 2;
constexpr float kShadowOffsetMm = 0.05F;  // off the facets, which stand proud of the smooth surface
constexpr float kStepMm = 1.5F;           // depth between neighbours that makes an edge
constexpr float kFocusBlurPx = 0.45F;     // of the projector in focus
constexpr float kDefocusPxPerMm = 0.009F;

// Casts rays and gathers light for one placed scene.
class Caster {
 public:
  Caster(const Rig& rig, const RayScene& scene, const RenderOptions& options, std::uint64_t seed)
      : rig_(rig),
        scene_(scene),
        options_(options),
        seed_(static_cast<std::uint32_t>(seed * 0x9e3779b97f4a7c15ULL >> 32U)) {
    projector_centre_ = rig.T_projector_camera.inverse().translation_mm.cast<float>();
    up_ = rig.T_camera_belt.rotation.col(2).cast<float>();
    focus_mm_ = static_cast<float>((rig.T_projector_camera * rig.T_camera_belt.translation_mm).norm()) - 25.0F;
  }

  // `width_px`: of the square share of a pixel that the ray stands for.
  [[nodiscard]] LightSample trace(const Vec3f& ray, float width_px) const {
    LightSample sample;
    const RayHit hit = scene_.cast(Vec3f::Zero(), ray);
    if (hit.instance == kHitNothing) return sample;
    sample.instance = static_cast<std::int16_t>(hit.instance);
    sample.distance = hit.distance;
    const Vec3f point = hit.distance * ray;
    const Surface surface = surface_at(hit, ray, width_px, sample);
    const Vec3f to_eye = -ray.normalized();
    const float vignetting = std::pow(-to_eye.z(), 4.0F);  // the cosine-fourth law of the camera's lens
    sample.ambient = scattered_ambient(surface, up_) * vignetting;
    light(point, hit, surface, to_eye, sample);
    sample.direct *= vignetting;
    return sample;
  }

 private:
  [[nodiscard]] Surface surface_at(const RayHit& hit, const Vec3f& ray, float width_px, LightSample& sample) const {
    if (hit.instance == kHitBelt) {
      return options_.background == Background::kPlane ? matt_plane_surface(hit.normal)
                                                       : belt_surface(hit.local_mm, hit.normal, seed_);
    }
    const std::uint32_t seed = seed_ + 977U * static_cast<std::uint32_t>(hit.instance + 1);
    const ScenePart& part = scene_.part(scene_.instances()[hit.instance].part);
    if (part.finish == Finish::kSteel) return steel_surface(hit.local_mm, hit.normal, seed);
    if (part.finish == Finish::kMattWhite) return painted_surface(hit.local_mm, hit.normal, seed);
    const float share = ink_share(hit, *part.print, ray, width_px);
    sample.ink = share <= 0.0F ? Ink::kNone : share >= 1.0F ? Ink::kAll : Ink::kMixed;
    return printed_surface(hit.local_mm, hit.normal, share, seed);
  }

  // The print within the ray's footprint: a square of the image, seen on the surface as a parallelogram and taken for
  // the rectangle of the same variance along the print's axes.
  [[nodiscard]] float ink_share(const RayHit& hit, const BoardPrint& print, const Vec3f& ray, float width_px) const {
    constexpr float kPrintedFaceMm = 0.5F;  // the print is on the face at z = 0 only
    if (hit.local_mm.z() > kPrintedFaceMm) return 0.0F;
    const Mat3& rotation = scene_.instances()[hit.instance].T_camera_part.rotation;
    const auto on_surface = [&](const Vec3f& step) {
      const Vec3f moved = step - ray * (hit.normal.dot(step) / hit.normal.dot(ray));
      return Vec3f(rotation.transpose().cast<float>() * moved);
    };
    const float step_mm = hit.distance * width_px;
    const Vec3f across = on_surface({step_mm / static_cast<float>(rig_.camera.fx_px), 0.0F, 0.0F});
    const Vec3f down = on_surface({0.0F, step_mm / static_cast<float>(rig_.camera.fy_px), 0.0F});
    return print.ink_share(hit.local_mm.x(), hit.local_mm.y(), std::hypot(across.x(), down.x()),
                           std::hypot(across.y(), down.y()));
  }

  // The projector's light at the point: its coordinates there, and how much of it goes to the eye.
  void light(const Vec3f& point, const RayHit& hit, const Surface& surface, const Vec3f& to_eye,
             LightSample& sample) const {
    const Vec3 lit = rig_.T_projector_camera * point.cast<double>();
    if (lit.z() <= 0.0) return;
    const Eigen::Vector2d pixel = rig_.projector.project(lit);
    sample.column_px = static_cast<float>(pixel.x());
    sample.row_px = static_cast<float>(pixel.y());
    const auto range_mm = static_cast<float>(lit.norm());
    sample.blur_level = static_cast<std::uint8_t>(
        PatternLight::blur_level(std::hypot(kFocusBlurPx, kDefocusPxPerMm * (range_mm - focus_mm_))));
    const bool in_image = pixel.x() > -0.5 && pixel.x() < rig_.projector.width - 0.5 && pixel.y() > -0.5 &&
                          pixel.y() < rig_.projector.height - 0.5;
    const Vec3f off = point + kShadowOffsetMm * hit.face_normal;
    const Vec3f to_light = projector_centre_ - off;
    if (!in_image || hit.face_normal.dot(to_light) <= 0.0F || scene_.blocked(off, to_light)) return;
    const auto cosine = static_cast<float>(lit.z()) / range_mm;
    const float falloff = focus_mm_ * focus_mm_ / (range_mm * range_mm) * cosine * cosine * cosine;
    sample.direct = falloff * scattered(surface, to_light.normalized(), to_eye);
  }

  const Rig& rig_;
  const RayScene& scene_;
  const RenderOptions& options_;
  std::uint32_t seed_;
  Vec3f projector_centre_, up_;
  float focus_mm_;
};

void in_parallel(int rows, const std::function<void(int)>& do_row) {
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int row = t; row < rows; row += kThreads) do_row(row);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

void resize(LightMap& map, const RichLens& camera) {
  map.rows = camera.height;
  map.cols = camera.width;
  for (auto* values : {&map.column_px, &map.row_px, &map.direct, &map.ambient}) values->resize(map.size());
  map.blur_level.resize(map.size());
  map.lit.resize(map.size());
  map.point_mm.resize(map.size());
  map.instance.resize(map.size());
  map.ink.resize(map.size());
}

void store(const LightSample& sample, const Vec3f& ray, std::size_t at, LightMap& map) {
  map.column_px[at] = sample.column_px;
  map.row_px[at] = sample.row_px;
  map.direct[at] = sample.direct;
  map.ambient[at] = sample.ambient;
  map.blur_level[at] = sample.blur_level;
  map.lit[at] = sample.direct > 0.0F ? 1 : 0;
  map.point_mm[at] = sample.distance * ray;
  map.ink[at] = sample.ink;
  map.instance[at] = sample.instance >= 0 ? static_cast<std::uint16_t>(sample.instance + 1) : std::uint16_t{0};
}

bool differ(const LightMap& map, std::size_t a, std::size_t b) {
  return map.instance[a] != map.instance[b] || map.lit[a] != map.lit[b] || map.ink[a] != map.ink[b] ||
         std::abs(map.point_mm[a].z() - map.point_mm[b].z()) > kStepMm;
}

void find_edges(LightMap& map) {
  std::vector<std::uint8_t> edge(map.size(), 0);
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      const std::size_t at = static_cast<std::size_t>(row) * map.cols + col;
      if (map.ink[at] == Ink::kMixed) edge[at] = 1;
      if (col + 1 < map.cols && differ(map, at, at + 1)) edge[at] = edge[at + 1] = 1;
      if (row + 1 < map.rows && differ(map, at, at + map.cols)) edge[at] = edge[at + map.cols] = 1;
    }
  }
  map.edges.clear();
  for (std::size_t at = 0; at < edge.size(); ++at) {
    if (edge[at] == 0) continue;
    map.edges.push_back(
        {static_cast<std::uint32_t>(at),
         static_cast<std::uint32_t>(map.edges.size() * static_cast<std::size_t>(map.samples_per_edge))});
  }
}

// Replaces an edge pixel's light by that of a grid of rays over the pixel's area.
void refine_edge(const LightMap::Edge& edge, const Caster& caster, const RayTable& rays, int side, LightMap& map) {
  const int row = static_cast<int>(edge.pixel / map.cols);
  const int col = static_cast<int>(edge.pixel % map.cols);
  const float share = 1.0F / static_cast<float>(side * side);
  float ambient = 0.0F;
  for (int n = 0; n < side * side; ++n) {
    const auto offset = [side](int i) { return (static_cast<float>(i) + 0.5F) / static_cast<float>(side) - 0.5F; };
    LightSample sample =
        caster.trace(rays.at(row, col, offset(n / side), offset(n % side)), 1.0F / static_cast<float>(side));
    sample.direct *= share;
    ambient += share * sample.ambient;
    map.edge_samples[edge.first + n] = sample;
  }
  map.ambient[edge.pixel] = ambient;
  map.direct[edge.pixel] = 0.0F;
}

}  // namespace

RayTable::RayTable(const RichLens& camera) : cols_(camera.width + 2) {
  ray_.resize(static_cast<std::size_t>(cols_) * (camera.height + 2));
  in_parallel(camera.height + 2, [&](int row) {
    for (int col = 0; col < cols_; ++col) {
      ray_[static_cast<std::size_t>(row) * cols_ + col] = camera.ray({col - 1.0, row - 1.0}).cast<float>();
    }
  });
}

Vec3f RayTable::at(int row, int col, float row_offset, float col_offset) const {
  const Vec3f* centre = &ray_[static_cast<std::size_t>(row + 1) * cols_ + col + 1];
  return *centre + 0.5F * row_offset * (centre[cols_] - centre[-cols_]) + 0.5F * col_offset * (centre[1] - centre[-1]);
}

void fill_light_map(const Rig& rig, const RayTable& rays, const RayScene& scene, const RenderOptions& options,
                    std::uint64_t seed, LightMap& map) {
  const Caster caster(rig, scene, options, seed);
  resize(map, rig.camera);
  in_parallel(map.rows, [&](int row) {
    for (int col = 0; col < map.cols; ++col) {
      const Vec3f ray = rays.at(row, col);
      store(caster.trace(ray, 1.0F), ray, static_cast<std::size_t>(row) * map.cols + col, map);
    }
  });
  map.samples_per_edge = options.edge_samples * options.edge_samples;
  find_edges(map);
  map.edge_samples.resize(map.edges.size() * static_cast<std::size_t>(map.samples_per_edge));
  in_parallel(static_cast<int>(map.edges.size()),
              [&](int i) { refine_edge(map.edges[i], caster, rays, options.edge_samples, map); });
}

}  // namespace beltpick::virtual_cell
