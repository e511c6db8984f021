#include "simulate_options.hpp"

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "contract_io/capture_io.hpp"
#include "options.hpp"

namespace beltpick::cli {
namespace {

namespace vc = virtual_cell;

void add_rig_options(CLI::App& app, SimulateOptions& options) {
  app.add_option("--rig", options.rig_file,
                 "TOML file of the optics: camera_width, camera_height, projector_width, projector_height, layout, "
                 "camera_distance_mm, projector_distance_mm, angle_deg, field_width_mm, camera_tilt_deg, distortion")
      ->type_name("FILE");
  app.add_option("--camera", options.camera_size, "camera size in pixels (default 1280x960)");
  app.add_option("--projector", options.projector_size, "projector size in pixels (default 912x1140)");
  app.add_option("--distance-mm", options.rig.camera_distance_mm, "camera to belt (default 700)");
  app.add_option("--angle-deg", options.rig.angle_deg, "between the axes of camera and projector (default 30)");
  app.add_option("--drift-px", options.drift_px,
                 "move principal points and borders of both images by so much since the calibration (default 0)")
      ->check(CLI::Range(0.0, 50.0));
  app.add_option("--drift-mm", options.drift_mm, "move the projector by so much since the calibration (default 0)")
      ->check(CLI::Range(0.0, 50.0));
  app.add_option("--field-mm", options.rig.field_width_mm, "width in view at the belt (default 400)");
}

void add_light_options(CLI::App& app, SimulateOptions& options) {
  app.add_flag("--noise-free", options.noise_free, "no noise, flicker or sway; 8 bits all the same");
  app.add_option("--projector-gamma", options.render.projector_gamma, "light over pattern value (default 1.03)")
      ->check(CLI::Range(0.3, 3.0));
  app.add_option("--ambient", options.render.ambient_share, "ambient light against white (default 0.06)")
      ->check(CLI::Range(0.0, 2.0));
  app.add_option(
         "--camera-blur-px", options.render.camera_blur_px,
         "standard deviation of the camera lens's point spread (default 0; plates and targets 0.4); 3: out of focus")
      ->check(CLI::Range(0.0, 20.0));
  app.add_option("--projector-blur-px", options.render.projector_blur_px,
                 "standard deviation of the projector's defocus beyond its depth of field's (default 0)")
      ->check(CLI::Range(0.0, 20.0));
  app.add_option("--interreflection", options.render.interreflection,
                 "light that surfaces throw on each other: 0 none (default) to 1, as it is; slower")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--beat", options.render.beat_frames,
                 "frames of a free-running projector in an exposure, e.g. 1.3 (default 0: synchronised)")
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--sway-mm", options.render.sway_mm, "sway of the belt at its stop (default 0.25)")
      ->check(CLI::Range(0.0, 20.0));
  app.add_option("--exposure-us", options.render.nominal_exposure_us, "of every frame (default 8000)")
      ->check(CLI::Range(1.0, 1e7));
  app.add_option("--white-level", options.render.white_level,
                 "of full scale, that white reaches on parts (default 0.87)")
      ->check(CLI::Range(0.05, 4.0));
}

}  // namespace

const std::vector<std::string>& lay_names() {
  static const std::vector<std::string> names{"flat", "edge", "any", "leaning", "cut", "dropped", "propped"};
  return names;
}

void add_simulate_options(CLI::App& app, SimulateOptions& options) {
  app.add_option("--out", options.out, "folder of the capture; with --count of 000, 001, ...")->type_name("DIR");
  app.add_option("--scene", options.scene,
                 "paper:1..12, belt, bare, plane (of the belt, or --height-mm, --tilt-deg); calibration: plate, "
                 "plate-on-belt; known shapes: planes (spread by seed), sphere (a ball bar), steps (default belt)");
  app.add_option("--part", options.parts,
                 "knuckle, elbow, bracket, vblock, balljoint, sheet or a mesh file; repeat to mix (default knuckle)");
  app.add_option("--mm-per-unit", options.mm_per_unit, "of mesh files (default 1)")->check(CLI::Range(1e-6, 1e6));
  app.add_option("--parts", options.parts_in_view,
                 "parts in view of a belt (default 3); live: on the belt (default 24)")
      ->check(CLI::Range(1, 100'000));
  app.add_option(
         "--lay", options.lays,
         "how each of them lies: flat, edge, any, leaning, cut, dropped, propped (any orientation, as held by hand)")
      ->delimiter(',')
      ->check(CLI::IsMember(lay_names()));
  app.add_option("--seed", options.seed, "of scene, surfaces and noise (default 1)");
  app.add_option("--count", options.count, "captures, seeds counting up (default 1)")->check(CLI::Range(1, 1000));
  app.add_option("--sequence", options.sequence, "fast, standard, robust or a sequence.json (default standard)");
  app.add_option("--axes", options.axes, "what a named sequence codes (default column; plates both)")
      ->check(CLI::IsMember(choices(kSequenceAxesNames)));
  app.add_option("--write-parts", options.write_parts, "write meshes and grasps of the parts")->type_name("DIR");
  add_rig_options(app, options);
  add_light_options(app, options);
  app.add_option(
      "--board", options.board,
      "plate: inner corners, columns x rows (default 11x8); live: what the trigger board is: emulated, the firmware's "
      "real ELF in an emulated microcontroller, or host, its core on this PC (default host)");
  add_target_options(app, options.targets);
  add_live_options(app, options.live);
}

Result<vc::Rig> chosen_rig(const SimulateOptions& options, const CLI::App& app) {
  vc::RigOptions chosen = options.rig;
  if (!options.rig_file.empty()) {
    for (const char* flag : {"--distance-mm", "--angle-deg", "--field-mm"}) {
      if (app.count(flag) > 0) return failure(ResultCode::kUsage, "%s: does not go with --rig; write it there", flag);
    }
    const auto read = vc::read_rig_options(options.rig_file);
    if (!read) return std::unexpected(read.error());
    chosen = *read;
  }
  if (!options.camera_size.empty()) {
    const auto size = parse_size(options.camera_size, "--camera");
    if (!size) return std::unexpected(size.error());
    chosen.camera_width = size->width;
    chosen.camera_height = size->height;
  }
  if (!options.projector_size.empty()) {
    const auto size = parse_size(options.projector_size, "--projector");
    if (!size) return std::unexpected(size.error());
    chosen.projector_width = size->width;
    chosen.projector_height = size->height;
  }
  return vc::make_rig(chosen);
}

Result<Sequence> chosen_sequence(const SimulateOptions& options, const vc::Rig& rig, const Session& session) {
  const ProjectorGrid grid{rig.projector.width, rig.projector.height, rig.layout};
  if (const auto named = find_sequence_name(options.sequence)) {
    return make_sequence(*named, grid, enum_of<SequenceAxes>(options.axes, kSequenceAxesNames));
  }
  contract_io::Warnings warnings;
  auto sequence = contract_io::read_sequence(options.sequence, warnings);
  session.warn(warnings);
  if (sequence && (sequence->projector.width != grid.width || sequence->projector.height != grid.height)) {
    return failure(ResultCode::kCalibrationMismatch,
                   "%s: projector: expected the rig's %dx%d, found %dx%d; give --projector to match",
                   options.sequence.c_str(), grid.width, grid.height, sequence->projector.width,
                   sequence->projector.height);
  }
  return sequence;
}

}  // namespace beltpick::cli
