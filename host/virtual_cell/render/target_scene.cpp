#include "virtual_cell/render/target_scene.hpp"

namespace beltpick::virtual_cell {

TargetScene plate_scene(const Rig& rig, const Plate& plate, const Pose<frame::Belt, frame::Part>& T_belt_plate) {
  const PlateOptions& made = plate.options();
  TruePlate truth;
  truth.columns = made.board.columns;
  truth.rows = made.board.rows;
  truth.square_mm = made.board.square_mm;
  truth.charuco = made.board.charuco;
  truth.width_mm = made.board.width_mm() + 2.0 * made.quiet_zone_mm;
  truth.height_mm = made.board.height_mm() + 2.0 * made.quiet_zone_mm;
  truth.thickness_mm = made.thickness_mm;
  truth.bend_mm = made.bend_mm;
  truth.T_camera_plate = rig.T_camera_belt * T_belt_plate;
  truth.corner_plate_mm = plate.corners_mm();
  for (const Vec3& corner : truth.corner_plate_mm) {
    const Vec3 seen = truth.T_camera_plate * corner;
    truth.corner_camera_px.push_back(rig.camera.project(seen));
    truth.corner_projector_px.push_back(rig.projector.project(rig.T_projector_camera * seen));
  }
  TargetScene scene;
  scene.instances.push_back({0, truth.T_camera_plate});
  scene.plate = std::move(truth);
  return scene;
}

}  // namespace beltpick::virtual_cell
