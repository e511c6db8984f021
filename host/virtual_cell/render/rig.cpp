// Builds a rig from the few numbers that describe it.
#include "virtual_cell/render/rig.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

// Distortion is given at the image's corner, so that lenses of every field of view bend lines alike.
void set_distortion(RichLens& lens, double strength, double sign) {
  const double corner_x = std::max(lens.cx_px, lens.width - 1.0 - lens.cx_px) / lens.fx_px;
  const double corner_y = std::max(lens.cy_px, lens.height - 1.0 - lens.cy_px) / lens.fy_px;
  const double r2 = corner_x * corner_x + corner_y * corner_y;
  const double r = std::sqrt(r2);
  lens.k = {sign * -0.016 * strength / r2, 0.004 * strength / (r2 * r2), sign * 0.001 * strength / (r2 * r2 * r2),
            sign * 0.003 * strength / r2,  0.002 * strength / (r2 * r2), 0.001 * strength / (r2 * r2 * r2)};
  lens.p1 = sign * 2e-4 * strength / r;
  lens.p2 = -1.5e-4 * strength / r;
  lens.s = {3.0e-4 * strength / r, -2.6e-4 * strength / (r2 * r), -2.4e-4 * strength / r,
            sign * 2.2e-4 * strength / (r2 * r)};
}

RichLens make_camera(const RigOptions& options) {
  RichLens lens{.width = options.camera_width, .height = options.camera_height};
  lens.fx_px = options.camera_width * options.camera_distance_mm / options.field_width_mm;
  lens.fy_px = lens.fx_px * 1.0006;
  lens.cx_px = (lens.width - 1) / 2.0 + 0.005 * lens.width;
  lens.cy_px = (lens.height - 1) / 2.0 - 0.004 * lens.height;
  set_distortion(lens, options.distortion, 1.0);
  return lens;
}

// Camera and projector look at the same point of the belt; the projector stands on the camera's +x side.
Pose<frame::Projector, frame::Camera> place_projector(const RigOptions& options) {
  const double angle = rad_from_deg(options.angle_deg);
  const Vec3 target(0.0, 0.0, options.camera_distance_mm);
  const Vec3 centre = target + options.projector_distance_mm * Vec3(std::sin(angle), 0.012, -std::cos(angle));
  const Vec3 z = (target - centre).normalized();
  const Vec3 roll_y = Eigen::AngleAxisd(rad_from_deg(0.8), z) * Vec3::UnitY();
  const Vec3 x = roll_y.cross(z).normalized();
  Mat3 rotation;
  rotation.row(0) = x;
  rotation.row(1) = z.cross(x);
  rotation.row(2) = z;
  return {rotation, -(rotation * centre)};
}

// Where the camera's field, at the belt and kPartHeightMm above it, falls in the projector's normalised image.
Eigen::AlignedBox2d lit_field(const Rig& rig) {
  Eigen::AlignedBox2d box;
  const Vec3 up = rig.T_camera_belt.rotation.col(2);
  const double belt = up.dot(rig.T_camera_belt.translation_mm);
  for (const double height_mm : {0.0, kPartHeightMm}) {
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        const Vec3 ray = rig.camera.ray({(rig.camera.width - 1) * i / 8.0, (rig.camera.height - 1) * j / 8.0});
        const Vec3 point = rig.T_projector_camera * Vec3(ray * ((belt + height_mm) / up.dot(ray)));
        box.extend(Eigen::Vector2d(point.head<2>() / point.z()));
      }
    }
  }
  return box;
}

RichLens make_projector(const RigOptions& options, const Rig& rig) {
  constexpr double kUsedShare = 0.95;
  RichLens lens{.width = options.projector_width, .height = options.projector_height};
  const Eigen::AlignedBox2d field = lit_field(rig);
  lens.fx_px = kUsedShare * lens.width / field.sizes().x();
  lens.fy_px = kUsedShare * lens.height / field.sizes().y();
  lens.cx_px = (lens.width - 1) / 2.0 - lens.fx_px * field.center().x();
  lens.cy_px = (lens.height - 1) / 2.0 - lens.fy_px * field.center().y();
  set_distortion(lens, options.distortion, -1.0);
  return lens;
}

bool within(double value, double low, double high) { return value >= low && value <= high; }

const char* what_is_wrong(const RigOptions& o) {
  if (!within(o.camera_width, 64, 8192) || !within(o.camera_height, 64, 8192)) return "camera size: expected 64..8192";
  if (!within(o.projector_width, 64, 8192) || !within(o.projector_height, 64, 8192))
    return "projector size: expected 64..8192";
  if (!within(o.camera_distance_mm, 100, 5000)) return "camera_distance_mm: expected 100..5000";
  if (!within(o.projector_distance_mm, 100, 5000)) return "projector_distance_mm: expected 100..5000";
  if (!within(std::abs(o.angle_deg), 5, 60)) return "angle_deg: expected 5..60 either way";
  if (!within(o.field_width_mm, 0.1 * o.camera_distance_mm, 1.2 * o.camera_distance_mm))
    return "field_width_mm: expected 0.1..1.2 of camera_distance_mm";
  if (!within(std::abs(o.camera_tilt_deg), 0, 30)) return "camera_tilt_deg: expected 0..30 either way";
  if (!within(o.distortion, 0, 4)) return "distortion: expected 0..4";
  return nullptr;
}

}  // namespace

Result<Rig> make_rig(const RigOptions& options) {
  if (const char* wrong = what_is_wrong(options))
    return failure(ResultCode::kValueOutOfRange, "rig: %s; correct the rig's options", wrong);
  Rig rig;
  rig.layout = options.layout;
  rig.camera = make_camera(options);
  // Belt x runs along camera x, belt z against the view; the tilt turns the camera about its x axis.
  Mat3 facing;
  facing << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const Mat3 tilt = Eigen::AngleAxisd(rad_from_deg(options.camera_tilt_deg), Vec3::UnitX()).toRotationMatrix();
  rig.T_camera_belt = {tilt * facing, Vec3(0.0, 0.0, options.camera_distance_mm)};
  rig.T_projector_camera = place_projector(options);
  rig.projector = make_projector(options, rig);
  rig.T_robot_belt = {Eigen::AngleAxisd(rad_from_deg(90.0), Vec3::UnitZ()).toRotationMatrix(),
                      Vec3(620.0, 40.0, -85.0)};
  return rig;
}

Rig drifted(const Rig& rig, double px, double mm, std::uint64_t seed) {
  Random random(seed, 53);
  Rig warm = rig;
  for (RichLens* lens : {&warm.camera, &warm.projector}) {
    const double angle = random.uniform(0.0, 2.0 * kPi);
    lens->cx_px += px * std::cos(angle);
    lens->cy_px += px * std::sin(angle);
    const double scale = 1.0 + (random.uniform() < 0.5 ? 2.0 : -2.0) * px / lens->width;
    lens->fx_px *= scale;
    lens->fy_px *= scale;
  }
  const double height = random.uniform(-1.0, 1.0);
  const double turn = random.uniform(0.0, 2.0 * kPi);
  const double level = std::sqrt(1.0 - height * height);
  warm.T_projector_camera.translation_mm += mm * Vec3(level * std::cos(turn), level * std::sin(turn), height);
  return warm;
}

}  // namespace beltpick::virtual_cell
