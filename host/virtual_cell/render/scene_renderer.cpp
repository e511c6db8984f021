#include "virtual_cell/render/scene_renderer.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "virtual_cell/render/bounced_light.hpp"
#include "virtual_cell/render/camera_blur.hpp"
#include "virtual_cell/render/light_map.hpp"
#include "virtual_cell/render/pattern_light.hpp"
#include "virtual_cell/render/ray_scene.hpp"
#include "virtual_cell/render/sensor_noise.hpp"
#include "virtual_cell/render/visibility.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kFlickerHz = 100.0;
constexpr double kFlickerDepth = 0.35;
constexpr float kScatteredShare = 0.012F;  // of the projector's mean light, reaching every surface by way of others
constexpr double kSwayHz = 8.0;
constexpr double kSwayDecayS = 0.09;
constexpr double kReferenceAlbedo = 0.35;  // what the exposure is set for before the first part is seen

// Mean of the ambient light over an exposure that starts at `time_s`.
double ambient_light(double time_s, double exposure_s, bool flickering) {
  if (!flickering || exposure_s <= 0.0) return 1.0;
  const double omega = 2.0 * kPi * kFlickerHz;
  const double swing = std::sin(omega * (time_s + exposure_s)) - std::sin(omega * time_s);
  return 1.0 + kFlickerDepth * swing / (omega * exposure_s);
}

}  // namespace

struct SceneRenderer::State {
  Rig rig;
  RenderOptions options;
  RayScene scene;
  RayTable rays;
  PatternLight light;
  CameraBlur blur;
  SensorNoise sensor;
  LightMap map;
  BouncedLight bounced;
  std::vector<float> signal;  // share of full scale
  std::vector<float> shifted;
  double gain = 0.0;  // signal per radiance at the nominal exposure
  std::uint64_t noise_seed = 0;
  // How the belt's image and the projector's coordinates on it change along the image's x.
  float pixels_per_mm = 0.0F, column_per_pixel = 0.0F, row_per_pixel = 0.0F;

  State(const Rig& rig_, std::span<const ScenePart> parts, const RenderOptions& options_)
      : rig(rig_),
        options(options_),
        scene(parts, rig_.T_camera_belt),
        rays(rig_.camera),
        light({rig_.projector.width, rig_.projector.height, rig_.layout}, options_.projector_gamma,
              options_.projector_blur_px),
        blur(options_.camera_blur_px) {
    const Vec3 step_mm = rig.T_camera_belt * Vec3(1.0, 0.0, 0.0);
    const Vec3 origin_mm = rig.T_camera_belt.translation_mm;
    pixels_per_mm = static_cast<float>((rig.camera.project(step_mm) - rig.camera.project(origin_mm)).x());
    const Eigen::Vector2d lit_step = rig.projector.project(rig.T_projector_camera * step_mm) -
                                     rig.projector.project(rig.T_projector_camera * origin_mm);
    column_per_pixel = static_cast<float>(lit_step.x()) / pixels_per_mm;
    row_per_pixel = static_cast<float>(lit_step.y()) / pixels_per_mm;
    gain = options.white_level * kPi / kReferenceAlbedo;
  }

  void set_gain();
  void add_light(float per_radiance, float shift_px);
  void shift_scene(float shift_px);
};

// The exposure that brings the brightest percentile of the parts (or of the plane) to the wanted level in a white
// frame, which the light around them is part of.
void SceneRenderer::State::set_gain() {
  const auto around = static_cast<float>(options.ambient_share) + kScatteredShare;
  std::vector<float> bright;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const bool counts = options.background == Background::kPlane || map.instance[i] != 0;
    if (counts && map.direct[i] > 0.0F) bright.push_back(map.direct[i] + around * map.ambient[i]);
  }
  if (bright.size() < 1000) return;
  const auto percentile = bright.begin() + static_cast<std::ptrdiff_t>(bright.size() * 99 / 100);
  std::nth_element(bright.begin(), percentile, bright.end());
  gain = options.white_level / *percentile;
}

// Adds the projector's light to `signal`. When the scene has moved by `shift_px`, its points meet another part of the
// pattern: the belt, whose image the shift leaves as it is, must keep its projector coordinates.
void SceneRenderer::State::add_light(float per_radiance, float shift_px) {
  const bool columns = light.axis() == Axis::kColumn;
  const float moved = shift_px * (columns ? column_per_pixel : row_per_pixel);
  const std::vector<float>& coordinate = columns ? map.column_px : map.row_px;
  for (std::size_t i = 0; i < map.size(); ++i) {
    signal[i] += per_radiance * map.direct[i] * light.at(coordinate[i] + moved, map.blur_level[i]);
  }
  for (const LightMap::Edge& edge : map.edges) {
    float sum = 0.0F;
    for (int n = 0; n < map.samples_per_edge; ++n) {
      const LightSample& sample = map.edge_samples[edge.first + n];
      sum += sample.direct * light.at((columns ? sample.column_px : sample.row_px) + moved, sample.blur_level);
    }
    signal[edge.pixel] += per_radiance * sum;
  }
  bounced.add(light, moved, per_radiance, signal);
}

// Moves `signal` along the image's x; what comes in at the border repeats the last column.
void SceneRenderer::State::shift_scene(float shift_px) {
  shifted.resize(signal.size());
  const float whole = std::floor(shift_px);
  const float part = shift_px - whole;
  const int by = static_cast<int>(whole);
  for (int row = 0; row < map.rows; ++row) {
    const float* from = signal.data() + static_cast<std::size_t>(row) * map.cols;
    float* to = shifted.data() + static_cast<std::size_t>(row) * map.cols;
    for (int col = 0; col < map.cols; ++col) {
      const float near = from[std::clamp(col - by, 0, map.cols - 1)];
      to[col] = near + part * (from[std::clamp(col - by - 1, 0, map.cols - 1)] - near);
    }
  }
  signal.swap(shifted);
}

SceneRenderer::SceneRenderer(const Rig& rig, std::span<const ScenePart> parts, const RenderOptions& options)
    : state_(std::make_unique<State>(rig, parts, options)) {
  place({}, 0);
}
SceneRenderer::~SceneRenderer() = default;
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;

void SceneRenderer::place(std::span<const PartInstance> instances, std::uint64_t seed) {
  State& s = *state_;
  s.scene.place(instances);
  const Caster caster(s.rig, s.scene, s.options, seed);
  fill_light_map(s.rig.camera, s.rays, caster, s.options.edge_samples, s.map);
  if (s.options.interreflection > 0.0) s.bounced.build(s.rays, caster, s.map, s.options.interreflection);
  s.set_gain();
  s.noise_seed = seed * 1000003U;
}

void SceneRenderer::expose(const FrameSpec& frame, double exposure_us, double time_s, ImageView<std::uint8_t> image,
                           double belt_shift_mm) {
  State& s = *state_;
  if (s.options.beat_frames > 0.0 && exposure_us > 0.0) {
    const double frames_run = time_s * 1e6 * s.options.beat_frames / s.options.nominal_exposure_us;
    const double frames_exposed = s.options.beat_frames * exposure_us / s.options.nominal_exposure_us;
    s.light.set_response(s.light.pulsed(frames_exposed, frames_run - std::floor(frames_run)));
  }
  s.light.set(frame);
  const double sway_mm =
      s.options.noise ? s.options.sway_mm * std::exp(-time_s / kSwayDecayS) * std::cos(2.0 * kPi * kSwayHz * time_s)
                      : 0.0;
  const auto shift_px = static_cast<float>(belt_shift_mm + sway_mm) * s.pixels_per_mm;
  const auto per_radiance = static_cast<float>(s.gain * exposure_us / s.options.nominal_exposure_us);
  const auto around =
      static_cast<float>(s.options.ambient_share * ambient_light(time_s, exposure_us * 1e-6, s.options.noise)) +
      kScatteredShare * s.light.mean();
  s.signal.resize(s.map.size());
  for (std::size_t i = 0; i < s.map.size(); ++i) s.signal[i] = per_radiance * around * s.map.ambient[i];
  s.add_light(per_radiance, shift_px);
  if (std::abs(shift_px) > 1e-3F) s.shift_scene(shift_px);
  s.blur.apply(s.signal, s.map.rows, s.map.cols);
  if (s.options.noise) {
    s.sensor.expose(s.signal, ++s.noise_seed, image);
  } else {
    SensorNoise::expose_noise_free(s.signal, image);
  }
}

ImageView<const Vec3f> SceneRenderer::true_points_mm() const {
  return {state_->map.point_mm.data(), state_->map.rows, state_->map.cols};
}
ImageView<const std::uint16_t> SceneRenderer::true_instances() const {
  return {state_->map.instance.data(), state_->map.rows, state_->map.cols};
}
ImageView<const float> SceneRenderer::true_column_px() const {
  return {state_->map.column_px.data(), state_->map.rows, state_->map.cols};
}
ImageView<const float> SceneRenderer::true_row_px() const {
  return {state_->map.row_px.data(), state_->map.rows, state_->map.cols};
}
bool SceneRenderer::lit(int row, int column) const {
  return state_->map.lit[static_cast<std::size_t>(row) * state_->map.cols + column] != 0;
}

std::vector<double> SceneRenderer::visible_fractions() const {
  return virtual_cell::visible_fractions(state_->rig, state_->scene);
}

}  // namespace beltpick::virtual_cell
