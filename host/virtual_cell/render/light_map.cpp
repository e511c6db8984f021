#include "virtual_cell/render/light_map.hpp"

#include <cmath>

#include "virtual_cell/render/parallel_rows.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr float kStepMm = 1.5F;  // depth between neighbours that makes an edge

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

void fill_light_map(const RichLens& camera, const RayTable& rays, const Caster& caster, int edge_samples,
                    LightMap& map) {
  resize(map, camera);
  in_parallel(map.rows, [&](int row) {
    for (int col = 0; col < map.cols; ++col) {
      const Vec3f ray = rays.at(row, col);
      store(caster.trace(ray, 1.0F), ray, static_cast<std::size_t>(row) * map.cols + col, map);
    }
  });
  map.samples_per_edge = edge_samples * edge_samples;
  find_edges(map);
  map.edge_samples.resize(map.edges.size() * static_cast<std::size_t>(map.samples_per_edge));
  in_parallel(static_cast<int>(map.edges.size()),
              [&](int i) { refine_edge(map.edges[i], caster, rays, edge_samples, map); });
}

}  // namespace beltpick::virtual_cell
