// SceneRenderer: what the virtual cell's camera sees: parts on a belt under a projected pattern, frame by frame.
//
// place() casts the rays once, when the belt stops: through the camera's distorted lens onto parts and belt, from there
// to the projector (cast shadows) and into the projector's distorted image. expose() then only looks the pattern up for
// each pixel and adds the sensor's noise, fast enough to answer a camera trigger. Everything follows from the seed.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/image.hpp"
#include "base/pose.hpp"
#include "contract/capture.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

// One part lying in the scene: an index into the renderer's parts and its true pose.
struct PartInstance {
  int part = 0;
  Pose<frame::Camera, frame::Part> T_camera_part;
};

enum class Background : std::uint8_t {
  kBelt,  // dark, matt, textured
  kPlane  // the same surface, bright, matt and even: for the noise figure
};

struct RenderOptions {
  Background background = Background::kBelt;
  bool noise = true;                    // shot noise, read noise, flicker and sway; quantisation always
  double projector_gamma = 1.03;        // of the light over the pattern's value; 1: linear
  double interreflection = 0.0;         // of the light that surfaces throw on each other; 1: all of its first bounce
  double beat_frames = 0.0;             // frames of a free-running projector within an exposure; 0: synchronised
  double nominal_exposure_us = 8000.0;  // at which white reaches `white_level` on the brightest percentile of the parts
  double white_level = 0.87;            // of the camera's full scale
  double ambient_share = 0.06;          // ambient light against the projector's white
  double sway_mm = 0.25;                // amplitude of the belt's sway along its travel at time 0 after the stop
  double projector_blur_px = 0.0;  // standard deviation of the projector's defocus beyond that of its depth of field
  double camera_blur_px = 0.0;     // standard deviation of the camera lens's point spread
  int edge_samples = 4;            // an edge pixel is the mean of edge_samples squared rays
};

// Photo-electrons at the sensor's full scale, and its noise in darkness.
inline constexpr double kFullWellElectrons = 10000.0;
inline constexpr double kReadNoiseElectrons = 15.0;

class SceneRenderer {
 public:
  // Keeps references to nothing: rig and parts are copied into its ray tracer. Throws std::runtime_error when Embree
  // does not start.
  SceneRenderer(const Rig& rig, std::span<const ScenePart> parts, const RenderOptions& options = {});
  ~SceneRenderer();
  SceneRenderer(SceneRenderer&&) noexcept;
  SceneRenderer& operator=(SceneRenderer&&) noexcept;

  // Renders the geometry of a stopped belt (about a second, two threads). `seed` fixes surfaces, dirt and noise. An
  // empty scene is the bare belt; it keeps the light that the last parts had.
  void place(std::span<const PartInstance> instances, std::uint64_t seed);

  // One exposed frame of `rows` x `cols` = camera size. `time_s` counts from the stop of the belt: it drives sway and
  // the 100 Hz flicker. `belt_shift_mm` moves the scene along the travel (a belt that did not stand still). Not
  // thread-safe: one exposure at a time.
  void expose(const FrameSpec& frame, double exposure_us, double time_s, ImageView<std::uint8_t> image,
              double belt_shift_mm = 0.0);

  // The truth of what was placed. Points in the camera frame, mm, of every pixel's central ray; instance + 1, 0 the
  // belt.
  [[nodiscard]] ImageView<const Vec3f> true_points_mm() const;
  [[nodiscard]] ImageView<const std::uint16_t> true_instances() const;
  // True projector coordinates of every pixel's central ray, and whether the projector's light reaches it.
  [[nodiscard]] ImageView<const float> true_column_px() const;
  [[nodiscard]] ImageView<const float> true_row_px() const;
  [[nodiscard]] bool lit(int row, int column) const;

  // For each instance the share of the pixels that it would show alone, in an image large enough, that are in view and
  // not hidden by another part.
  [[nodiscard]] std::vector<double> visible_fractions() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace beltpick::virtual_cell
