// BouncedLight: the projector's light that reaches what the camera sees by way of one other surface.
//
// Such light is smooth over the image: it is gathered on a coarse grid of sites, from many directions each, and read
// between sites of the same surface. A site keeps where in the projector's image each of its gathered rays was lit, so
// that every frame of a sequence gives the mean of its own pattern over those places.
#pragma once

#include <cstdint>
#include <vector>

#include "virtual_cell/render/caster.hpp"
#include "virtual_cell/render/light_map.hpp"
#include "virtual_cell/render/pattern_light.hpp"

namespace beltpick::virtual_cell {

class BouncedLight {
 public:
  // Gathers for a filled light map. `strength`: 1 for what physics gives, less to weaken it. Some seconds.
  void build(const RayTable& rays, const Caster& caster, const LightMap& map, double strength);

  // Adds the bounced light of the frame that stands in `light`, `moved_px` along its axis, to a signal as large as the
  // map; nothing before build().
  void add(const PatternLight& light, float moved_px, float per_radiance, std::vector<float>& signal) const;

 private:
  // One gathered ray: where its light comes from in the projector's image, and how much of it goes to the eye.
  struct Ray {
    float column_px, row_px, weight;
    std::uint8_t blur_level;
  };
  struct Site {
    std::uint32_t pixel = 0;
    std::vector<Ray> rays;
    Vec3f normal = Vec3f::Zero();
  };
  // A share of a site's light that a pixel takes.
  struct Share {
    std::uint32_t site;
    float weight;
  };
  struct Pixel {
    std::uint32_t pixel, first_share, shares;
  };

  static Site gather(std::uint32_t pixel, const RayTable& rays, const Caster& caster, const LightMap& map,
                     double strength);
  void share_out(const LightMap& map, int grid_cols, std::vector<std::uint32_t>& orphans);
  void give(const LightMap& map, std::uint32_t pixel, const std::vector<Share>& shares);

  std::vector<Site> sites_;
  std::vector<Pixel> pixels_;
  std::vector<Share> shares_;
};

}  // namespace beltpick::virtual_cell
