// Rig: the true optics of a virtual cell: camera, projector, belt and robot, as no calibration ever knows them.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/pose.hpp"
#include "base/result.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "virtual_cell/render/lens.hpp"

namespace beltpick::virtual_cell {

// What describes a rig to a person; the default is the design's "default rig".
struct RigOptions {
  int camera_width = 1280, camera_height = 960;
  int projector_width = 912, projector_height = 1140;
  ProjectorLayout layout = ProjectorLayout::kSquare;
  double camera_distance_mm = 700.0;     // along the optical axis to the belt
  double projector_distance_mm = 780.0;  // along its axis to the same point of the belt
  double angle_deg = 30.0;               // between the two axes
  double field_width_mm = 400.0;         // in view across the image at the belt
  double camera_tilt_deg = 3.0;          // of the optical axis from the belt's normal
  double distortion = 1.0;               // multiplies every distortion term of both lenses
};

struct Rig {
  RichLens camera;
  RichLens projector;
  ProjectorLayout layout = ProjectorLayout::kSquare;
  Pose<frame::Projector, frame::Camera> T_projector_camera;
  Pose<frame::Camera, frame::Belt> T_camera_belt;  // belt origin: where the optical axis meets the belt's surface
  Pose<frame::Robot, frame::Belt> T_robot_belt;
};

// Lays out a rig. The projector's focal lengths and principal point follow from lighting the whole field of the camera
// up to kPartHeight above the belt, so that any size and angle gives a working rig (fx != fy in general).
// Errors: kValueOutOfRange for what cannot be built (sizes, angles, distances).
Result<Rig> make_rig(const RigOptions& options = {});

// Reads RigOptions from a TOML file whose keys are the members' names (layout: "square" or "diamond"); missing keys
// keep their default. Errors: kFileNotFound, kFormatInvalid (with the line), kValueOutOfRange.
Result<RigOptions> read_rig_options(const std::filesystem::path& file);

// The rig after it has warmed up since its calibration: both lenses' principal points moved by `px` in directions that
// the seed draws, their focal lengths changed so that the image's border moves by `px`, and the projector moved by `mm`
// against the camera.
Rig drifted(const Rig& rig, double px, double mm, std::uint64_t seed);

// Height above the belt that the projector lights within the camera's field.
inline constexpr double kPartHeightMm = 110.0;

}  // namespace beltpick::virtual_cell
