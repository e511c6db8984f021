#include "virtual_cell/render/bounced_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "virtual_cell/render/parallel_rows.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr int kStepPx = 4;        // between sites
constexpr int kRays = 192;        // a site
constexpr float kApartMm = 0.2F;  // off a site's tangent plane: another surface, or too curved to share
constexpr float kTwoPi = 2.0F * std::numbers::pi_v<float>;

// The n-th of the numbers that halve, quarter, ... the unit interval in turn (van der Corput).
float radical_inverse(std::uint32_t n) {
  float value = 0.0F;
  for (float place = 0.5F; n != 0; n >>= 1U, place *= 0.5F) value += (n & 1U) != 0 ? place : 0.0F;
  return value;
}

float hashed_share(std::uint32_t n) {
  n = (n ^ (n >> 16U)) * 0x85ebca6bU;
  n = (n ^ (n >> 13U)) * 0xc2b2ae35U;
  return static_cast<float>((n ^ (n >> 16U)) >> 8U) / 16777216.0F;
}

int site_row(int grid_row, int rows) { return std::min(grid_row * kStepPx, rows - 1); }

}  // namespace

// Rays spread by the cosine about the normal: a matt surface weighs them alike.
BouncedLight::Site BouncedLight::gather(std::uint32_t pixel, const RayTable& rays, const Caster& caster,
                                        const LightMap& map, double strength) {
  // One ray that meets a lobe end-on must not outshine the rest.
  constexpr float kBrightest = 4.0F;
  Site site;
  site.pixel = pixel;
  const Vec3f ray = rays.at(static_cast<int>(pixel) / map.cols, static_cast<int>(pixel) % map.cols);
  const auto spot = caster.meet(Vec3f::Zero(), ray, 0.0F);
  if (!spot) return site;
  site.normal = spot->hit.normal;
  // The relief is finer than a site; what it does to the light is not.
  Surface smooth = spot->surface;
  smooth.normal = site.normal;
  const Vec3f to_eye = -ray.normalized();
  const Vec3f origin = spot->point_mm + Caster::kOffSurfaceMm * spot->hit.face_normal;
  const Vec3f across = site.normal.unitOrthogonal();
  const Vec3f along = site.normal.cross(across);
  const float turn = hashed_share(pixel);
  for (std::uint32_t n = 0; n < kRays; ++n) {
    const float height = (static_cast<float>(n) + 0.5F) / kRays;
    const float angle = kTwoPi * (radical_inverse(n) + turn);
    const float cosine = std::sqrt(height);
    const float sine = std::sqrt(1.0F - height);
    const Vec3f direction = sine * (std::cos(angle) * across + std::sin(angle) * along) + cosine * site.normal;
    if (direction.dot(spot->hit.face_normal) <= 0.0F) continue;
    const LightSample seen = caster.look(origin, direction);
    if (seen.direct <= 0.0F) continue;
    const float passed =
        std::min(std::numbers::pi_v<float> * scattered(smooth, direction, to_eye) / cosine, kBrightest);
    const float weight = static_cast<float>(strength) / kRays * passed * seen.direct * vignetting(to_eye);
    if (weight > 0.0F) site.rays.push_back({seen.column_px, seen.row_px, weight, seen.blur_level});
  }
  return site;
}

void BouncedLight::give(const LightMap& map, std::uint32_t pixel, const std::vector<Share>& shares) {
  const bool dark = std::ranges::all_of(shares, [&](const Share& share) { return sites_[share.site].rays.empty(); });
  if (dark) return;
  pixels_.push_back({pixel, static_cast<std::uint32_t>(shares_.size()), static_cast<std::uint32_t>(shares.size())});
  for (Share share : shares) {
    // The grain of the surface, as it shows under even light.
    const float site_ambient = map.ambient[sites_[share.site].pixel];
    if (site_ambient > 0.0F) share.weight *= std::min(map.ambient[pixel] / site_ambient, 4.0F);
    shares_.push_back(share);
  }
}

// Gives each pixel its shares of the four sites round it that lie on the same surface; pixels that have none are
// orphans.
void BouncedLight::share_out(const LightMap& map, int grid_cols, std::vector<std::uint32_t>& orphans) {
  std::vector<Share> shares;
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      const auto pixel = static_cast<std::uint32_t>(row * map.cols + col);
      const float down = static_cast<float>(row % kStepPx) / kStepPx;
      const float right = static_cast<float>(col % kStepPx) / kStepPx;
      const std::array<float, 4> weight{(1 - down) * (1 - right), (1 - down) * right, down * (1 - right), down * right};
      shares.clear();
      float sum = 0.0F;
      for (int n = 0; n < 4; ++n) {
        const auto at = static_cast<std::uint32_t>((row / kStepPx + n / 2) * grid_cols + col / kStepPx + n % 2);
        const Site& site = sites_[at];
        const Vec3f apart = map.point_mm[pixel] - map.point_mm[site.pixel];
        if (weight[static_cast<std::size_t>(n)] <= 0.0F || map.instance[pixel] != map.instance[site.pixel] ||
            std::abs(site.normal.dot(apart)) > kApartMm) {
          continue;
        }
        shares.push_back({at, weight[static_cast<std::size_t>(n)]});
        sum += weight[static_cast<std::size_t>(n)];
      }
      if (shares.empty()) {
        orphans.push_back(pixel);
        continue;
      }
      for (Share& share : shares) share.weight /= sum;
      give(map, pixel, shares);
    }
  }
}

void BouncedLight::build(const RayTable& rays, const Caster& caster, const LightMap& map, double strength) {
  pixels_.clear();
  shares_.clear();
  // One row and column of sites more than pixels need, so that each pixel has four round it.
  const int grid_rows = (map.rows - 1) / kStepPx + 2;
  const int grid_cols = (map.cols - 1) / kStepPx + 2;
  sites_.assign(static_cast<std::size_t>(grid_rows) * grid_cols, {});
  in_parallel(grid_rows, [&](int i) {
    for (int j = 0; j < grid_cols; ++j) {
      const int pixel = site_row(i, map.rows) * map.cols + site_row(j, map.cols);
      sites_[static_cast<std::size_t>(i) * grid_cols + j] =
          gather(static_cast<std::uint32_t>(pixel), rays, caster, map, strength);
    }
  });
  std::vector<std::uint32_t> orphans;
  share_out(map, grid_cols, orphans);
  const std::size_t first = sites_.size();
  sites_.resize(first + orphans.size());
  in_parallel(static_cast<int>(orphans.size()), [&](int i) {
    sites_[first + static_cast<std::size_t>(i)] =
        gather(orphans[static_cast<std::size_t>(i)], rays, caster, map, strength);
  });
  for (std::size_t i = 0; i < orphans.size(); ++i) {
    give(map, orphans[i], {{static_cast<std::uint32_t>(first + i), 1.0F}});
  }
}

void BouncedLight::add(const PatternLight& light, float moved_px, float per_radiance,
                       std::vector<float>& signal) const {
  if (pixels_.empty()) return;
  const bool columns = light.axis() == Axis::kColumn;
  std::vector<float> radiance(sites_.size(), 0.0F);
  in_parallel(static_cast<int>(sites_.size()), [&](int i) {
    for (const Ray& ray : sites_[static_cast<std::size_t>(i)].rays) {
      radiance[static_cast<std::size_t>(i)] +=
          ray.weight * light.at((columns ? ray.column_px : ray.row_px) + moved_px, ray.blur_level);
    }
  });
  for (const Pixel& pixel : pixels_) {
    float sum = 0.0F;
    for (std::uint32_t n = 0; n < pixel.shares; ++n) {
      const Share& share = shares_[pixel.first_share + n];
      sum += share.weight * radiance[share.site];
    }
    signal[pixel.pixel] += per_radiance * sum;
  }
}

}  // namespace beltpick::virtual_cell
