#include "simulate_targets.hpp"

#include "options.hpp"
#include "virtual_cell/render/plate_poses.hpp"

namespace beltpick::cli {
namespace {

namespace vc = virtual_cell;

Result<vc::TargetStage> make_plate_stage(const TargetOptions& options, vc::PlatePoses how, const vc::Rig& rig,
                                         int count, std::uint64_t seed) {
  const auto corners = parse_size(options.board, "--board");
  if (!corners) return std::unexpected(corners.error());
  vc::PlateOptions wanted = options.plate;
  wanted.board.columns = corners->width;
  wanted.board.rows = corners->height;
  wanted.board.charuco = options.print == "charuco";
  const auto plate = vc::Plate::make(wanted, seed);
  if (!plate) return std::unexpected(plate.error());
  auto part = plate->part();
  if (!part) return std::unexpected(part.error());
  const auto poses = vc::choose_plate_poses(rig, *plate, how, count, seed);
  if (!poses) return std::unexpected(poses.error());
  vc::TargetStage stage;
  stage.parts.push_back(std::move(*part));
  for (const auto& pose : *poses) stage.scenes.push_back(vc::plate_scene(rig, *plate, pose));
  return stage;
}

}  // namespace

void add_target_options(CLI::App& app, TargetOptions& options) {
  app.add_option("--square-mm", options.plate.board.square_mm, "plate: side of a square (default 20)");
  app.add_option("--print", options.print,
                 "plate: chess, or charuco with DICT_4X4_100 markers of 0.75 squares (default chess)")
      ->check(CLI::IsMember({"chess", "charuco"}));
  app.add_option("--quiet-zone-mm", options.plate.quiet_zone_mm, "plate: white border round the print (default 10)");
  app.add_option("--plate-thickness-mm", options.plate.thickness_mm, "plate: its thickness (default 5)");
  app.add_option("--plate-bend-mm", options.plate.bend_mm,
                 "plate: how much its face is bent, the same for all captures (default 0.05)");
  app.add_option("--plate-poses", options.poses,
                 "plate: good, or as careless people hold it: flat, near (all alike), partial (out of view)")
      ->check(CLI::IsMember({"good", "flat", "near", "partial"}));
  app.add_option("--ball-radius-mm", options.balls.radius_mm, "sphere: radius of both balls (default 20)");
  app.add_option("--ball-distance-mm", options.balls.distance_mm, "sphere: between their centres (default 120)");
  app.add_option("--steps", options.steps.steps, "steps: how many, the lowest included (default 6)");
  app.add_option("--rise-mm", options.steps.rise_mm, "steps: from one to the next (default 20)");
  app.add_option("--height-mm", options.height_mm,
                 "plane: above the belt in the middle of the view (default: the belt)")
      ->check(CLI::Range(0.0, 110.0));
  app.add_option("--tilt-deg", options.tilt_deg, "plane: its tilt (default 0)")->check(CLI::Range(0.0, 40.0));
  app.add_option("--towards-deg", options.towards_deg, "plane: direction it falls to, from the belt's x (default 0)");
}

bool is_plate_scene(const std::string& scene) { return scene == "plate" || scene == "plate-on-belt"; }

bool is_target_scene(const std::string& scene, const TargetOptions& options) {
  if (scene == "plane") return options.height_mm.has_value() || options.tilt_deg.has_value();
  return is_plate_scene(scene) || scene == "planes" || scene == "sphere" || scene == "steps";
}

Result<vc::TargetStage> make_target_stage(const std::string& scene, const TargetOptions& options, const vc::Rig& rig,
                                          int count, std::uint64_t seed) {
  if (scene == "sphere") return vc::make_ball_bars(rig, options.balls, count, seed);
  if (scene == "steps") return vc::make_step_wedges(rig, options.steps, count, seed);
  if (scene == "planes") return vc::make_planes(rig, {}, count, seed);
  if (scene == "plane") {
    const vc::PlanePlace place{options.height_mm.value_or(0.0), options.tilt_deg.value_or(0.0), options.towards_deg};
    return vc::make_planes(rig, place, count, seed);
  }
  const auto how =
      scene == "plate-on-belt" ? vc::PlatePoses::kOnBelt : enum_of<vc::PlatePoses>(options.poses, vc::kPlatePosesNames);
  return make_plate_stage(options, how, rig, count, seed);
}

}  // namespace beltpick::cli
