// CodeCaster: projector codes of a scene by casting rays, with no frames between: for the bulk of a long run.
//
// What decoding would have made of the frames is drawn from what was measured of it: shading gives every pixel's
// fringe, the noise law its coordinate's deviation; shadows of the projector, dark and saturated pixels (glare) have no
// code; a pixel across an edge mixes the fringes of all that it sees (and flies); a few are off by a period. From there
// on the product measures: triangulation with the fitted calibration, its filter of flying pixels and all that follows.
#pragma once

#include <memory>
#include <vector>

#include "base/random.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "range/triangulator.hpp"
#include "virtual_cell/render/caster.hpp"
#include "virtual_cell/render/light_map.hpp"
#include "virtual_cell/render/rig.hpp"

namespace beltpick::bench {

class CodeCaster {
 public:
  // Keeps a reference to the rig. Throws std::runtime_error where the sequence cannot be decoded.
  CodeCaster(const virtual_cell::Rig& rig, std::span<const virtual_cell::ScenePart> parts,
             const Calibration& calibration, const Sequence& sequence);

  // The views stay good until the next call.
  RangeImage cast(std::span<const virtual_cell::PartInstance> instances, std::uint64_t seed);

  // The true points that light reaches, off by `noise_mm` (standard deviation) along the line of sight: no glare, no
  // mixed pixels, no error of the calibration.
  RangeImage cast_points(std::span<const virtual_cell::PartInstance> instances, std::uint64_t seed, double noise_mm);

  // Of the last cast: of every pixel 0, or i for the instance i - 1; and of each instance the share in view.
  [[nodiscard]] ImageView<const std::uint16_t> instances() const;
  [[nodiscard]] std::vector<double> visible_fractions() const;

 private:
  // What decoding gets of a pixel: one or more rays' light as a fringe.
  struct Pixel {
    virtual_cell::LightSample middle;
    float column_px = 0.0F, amplitude = 0.0F, ambient = 0.0F;  // per radiance
  };

  void trace(const virtual_cell::Caster& caster);
  void mix_edges(const virtual_cell::Caster& caster);
  [[nodiscard]] Pixel mixed(const virtual_cell::Caster& caster, int row, int col) const;
  [[nodiscard]] float gain() const;
  void decode(float gain, Random& random);
  void put_glare(Random& random);

  const virtual_cell::Rig& rig_;
  virtual_cell::RenderOptions options_;
  virtual_cell::RayScene scene_;
  virtual_cell::RayTable rays_;
  CodeNoise noise_;
  float period_px_ = 0.0F;
  int rows_ = 0, cols_ = 0;
  ArenaBlock block_;
  Arena arena_;
  range::Triangulator triangulator_;
  std::vector<Pixel> pixels_;
  std::vector<std::uint16_t> instance_;
  std::vector<float> column_px_, modulation_;
  std::vector<std::uint8_t> texture_;
  std::vector<PixelState> state_;
  std::vector<Vec3f> point_mm_;  // of cast_points
  std::vector<float> sigma_mm_;
};

}  // namespace beltpick::bench
