// beltpick simulate: scenes of the virtual cell written as CAPTURE folders with their truth.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "simulate_live.hpp"
#include "simulate_targets.hpp"
#include "virtual_cell/render/capture_folder.hpp"
#include "virtual_cell/render/rig_calibration.hpp"
#include "virtual_cell/render/scene.hpp"

namespace beltpick::cli {
namespace {

namespace vc = virtual_cell;

constexpr int kMaxPartsInView = 12;
constexpr double kTargetBlurPx = 0.4;  // of a good lens with pixels of 3 to 5 micrometres
const std::vector<std::string> kLays{"flat", "edge", "any", "leaning", "cut"};

struct SimulateOptions {
  std::string out, write_parts, rig_file, camera_size, projector_size, board;
  std::string scene = "belt", sequence = "standard", axes = "column";
  std::vector<std::string> parts{"knuckle"}, lays;
  double mm_per_unit = 1.0;
  int count = 1, parts_in_view = 3;
  std::uint64_t seed = 1;
  bool noise_free = false;
  double drift_px = 0.0, drift_mm = 0.0;
  vc::RigOptions rig;
  vc::RenderOptions render;
  TargetOptions targets;
  LiveOptions live;
};

Result<vc::Rig> make_rig(const SimulateOptions& options, const CLI::App& app) {
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

// A named sequence for the rig's projector, or a sequence.json made for it.
Result<Sequence> find_sequence(const SimulateOptions& options, const vc::Rig& rig, const Session& session) {
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

Result<std::vector<vc::ScenePart>> load_parts(const SimulateOptions& options) {
  std::vector<vc::ScenePart> parts;
  for (const std::string& name : options.parts) {
    auto part = vc::load_part(name, options.mm_per_unit);
    if (!part) return std::unexpected(part.error());
    parts.push_back(std::move(*part));
  }
  return parts;
}

Result<vc::Scene> lay_parts(const SimulateOptions& options, const vc::SceneMaker& maker, std::uint64_t seed) {
  if (options.scene.starts_with("paper:")) return maker.make_paper_scene(std::atoi(options.scene.c_str() + 6), seed);
  if (options.scene == "bare" || options.scene == "plane") return vc::Scene{};
  if (options.scene != "belt")
    return failure(
        ResultCode::kUsage,
        "--scene: expected paper:1..12, belt, plane, bare, plate, plate-on-belt, planes, sphere or steps, found '%s'",
        contract_io::one_line(options.scene).substr(0, 60).c_str());
  if (options.lays.empty() && options.parts_in_view == 3) return maker.make_belt(3, seed).front();
  std::vector<vc::Lay> lays(static_cast<std::size_t>(options.parts_in_view), vc::Lay::kAny);
  for (std::size_t i = 0; i < std::min(lays.size(), options.lays.size()); ++i) {
    lays[i] = static_cast<vc::Lay>(std::find(kLays.begin(), kLays.end(), options.lays[i]) - kLays.begin());
  }
  return maker.make(lays, seed);
}

Result<void> write_rig_files(const vc::Rig& rig, const Sequence& sequence, const std::filesystem::path& folder) {
  const Calibration calibration = vc::calibrate_rig(rig).calibration;
  if (auto made = contract_io::make_folder(folder); !made) return made;
  if (auto written = contract_io::write_calibration(folder / "calibration.json", calibration); !written) return written;
  if (auto written = contract_io::write_cell(folder / "cell.json", vc::make_cell(rig, calibration)); !written)
    return written;
  return contract_io::write_sequence(folder / "sequence.json", sequence);
}

struct Rendered {
  contract_io::Json captures = contract_io::Json::array();
  contract_io::Warnings warnings;
  std::string text;
};

// What a capture is of: parts laid down by seed, or a scene of known shape.
class Stage {
 public:
  static Result<Stage> make(const SimulateOptions& options, const vc::Rig& rig) {
    Stage stage(options, rig);
    if (is_target_scene(options.scene, options.targets)) {
      auto targets = make_target_stage(options.scene, options.targets, rig, options.count, options.seed);
      if (!targets) return std::unexpected(targets.error());
      stage.parts_ = std::move(targets->parts);
      stage.targets_ = std::move(targets->scenes);
      return stage;
    }
    auto parts = load_parts(options);
    if (!parts) return std::unexpected(parts.error());
    stage.parts_ = std::move(*parts);
    stage.maker_ = std::make_unique<vc::SceneMaker>(stage.parts_, rig);
    return stage;
  }

  [[nodiscard]] const std::vector<vc::ScenePart>& parts() const { return parts_; }

  Result<vc::TargetScene> scene(int k, contract_io::Warnings& warnings) const {
    if (maker_ == nullptr) return targets_[static_cast<std::size_t>(k)];
    const std::uint64_t seed = options_->seed + static_cast<std::uint64_t>(k);
    const auto scene = lay_parts(*options_, *maker_, seed);
    if (!scene) return std::unexpected(scene.error());
    const auto wanted = static_cast<std::size_t>(options_->scene == "belt" ? options_->parts_in_view : 0);
    if (scene->size() < wanted) {
      warnings.push_back("seed " + std::to_string(seed) + ": room for " + std::to_string(scene->size()) +
                         " parts in view, " + std::to_string(wanted) + " asked for");
    }
    return vc::TargetScene{vc::instances_of(*scene, *rig_), {}, {}};
  }

 private:
  Stage(const SimulateOptions& options, const vc::Rig& rig) : options_(&options), rig_(&rig) {}

  const SimulateOptions* options_;
  const vc::Rig* rig_;
  std::vector<vc::ScenePart> parts_;
  std::vector<vc::TargetScene> targets_;
  std::unique_ptr<vc::SceneMaker> maker_;
};

std::filesystem::path capture_folder(const SimulateOptions& options, int k) {
  if (options.count == 1) return options.out;
  char name[16];
  std::snprintf(name, sizeof name, "%03d", k);
  return std::filesystem::path(options.out) / name;
}

// The captures of --count scenes, one folder each.
Result<Rendered> render(const SimulateOptions& options, const vc::Rig& calibrated, const Sequence& sequence,
                        bool quiet) {
  Rendered rendered;
  const vc::Rig rig = vc::drifted(calibrated, options.drift_px, options.drift_mm, options.seed);
  const auto stage = Stage::make(options, rig);
  if (!stage) return std::unexpected(stage.error());
  vc::SceneRenderer renderer(rig, stage->parts(), options.render);
  const int frames = static_cast<int>(sequence.frames.size());
  // A plate is not held before a belt that has just stopped.
  vc::CaptureTiming timing;
  if (is_target_scene(options.scene, options.targets)) timing.settle_s = 5.0;
  for (const std::string& fault : options.live.named_faults) {
    if (auto added = timing.faults.add(fault); !added) return std::unexpected(added.error());
  }
  Progress progress("simulate", options.count * frames, quiet);
  int exposed = 0;
  for (int k = 0; k < options.count; ++k) {
    const auto scene = stage->scene(k, rendered.warnings);
    if (!scene) return std::unexpected(scene.error());
    const std::filesystem::path folder = capture_folder(options, k);
    if (auto written = write_rig_files(calibrated, sequence, folder); !written) return std::unexpected(written.error());
    renderer.place(scene->instances, options.seed + static_cast<std::uint64_t>(k));
    Truth truth = vc::truth_of(renderer, scene->instances, stage->parts());
    truth.plate = scene->plate;
    truth.targets = scene->targets;
    const auto written = vc::write_capture_folder(renderer, options.render, sequence, truth, timing, folder,
                                                  [&] { progress.show(++exposed); });
    if (!written) return std::unexpected(written.error());
    rendered.captures.push_back({{"folder", folder.string()}, {"parts", truth.parts.size()}, {"frames", frames}});
    rendered.text +=
        folder.string() + ": " + std::to_string(frames) + " frames, " + std::to_string(truth.parts.size()) + " parts\n";
  }
  return rendered;
}

// A belt of --parts parts, in real time.
Result<void> run_live(const SimulateOptions& options, const CLI::App& app, Session& session) {
  auto parts = load_parts(options);
  if (!parts) return std::unexpected(parts.error());
  const auto rig = make_rig(options, app);
  if (!rig) return std::unexpected(rig.error());
  auto sequence = find_sequence(options, *rig, session);
  if (!sequence) return std::unexpected(sequence.error());
  LiveCell cell{*rig, std::move(*parts), std::move(*sequence), options.render, 24, options.seed};
  if (app.count("--parts") > 0) cell.count = options.parts_in_view;
  return run_live(options.live, std::move(cell), session);
}

// --board names a plate's corners, or of a live cell the kind of trigger board.
Result<void> take_board(SimulateOptions& options) {
  if (options.board.empty()) return {};
  if (options.live.live && options.board != "emulated" && options.board != "host") {
    return failure(ResultCode::kUsage, "--board: expected emulated or host with --live, found '%s'",
                   contract_io::one_line(options.board).substr(0, 60).c_str());
  }
  (options.live.live ? options.live.board : options.targets.board) = options.board;
  return {};
}

Result<void> run(SimulateOptions options, const CLI::App& app, Session& session) {
  if (auto taken = take_board(options); !taken) return taken;
  options.render.noise = !options.noise_free;
  if (!options.lays.empty() && app.count("--parts") == 0) options.parts_in_view = static_cast<int>(options.lays.size());
  if (options.live.live) return run_live(options, app, session);
  if (options.parts_in_view > kMaxPartsInView) {
    return failure(ResultCode::kUsage, "--parts: expected at most %d in one view, found %d; more need --live",
                   kMaxPartsInView, options.parts_in_view);
  }
  contract_io::Json answer = contract_io::Json::object();
  std::string text;
  if (!options.write_parts.empty()) {
    const auto parts = load_parts(options);
    if (!parts) return std::unexpected(parts.error());
    for (const vc::ScenePart& part : *parts) {
      if (auto written = vc::write_part(part, options.write_parts); !written) return written;
      answer["parts"].push_back(options.write_parts + "/" + part.name + ".stl");
      text += options.write_parts + "/" + part.name + ".stl\n";
    }
  }
  if (!options.out.empty()) {
    if (is_plate_scene(options.scene) && app.count("--axes") == 0) options.axes = "both";
    if (is_target_scene(options.scene, options.targets)) {
      if (app.count("--camera-blur-px") == 0) options.render.camera_blur_px = kTargetBlurPx;
    }
    if (options.scene == "plane") options.render.background = vc::Background::kPlane;
    const auto rig = make_rig(options, app);
    if (!rig) return std::unexpected(rig.error());
    const auto sequence = find_sequence(options, *rig, session);
    if (!sequence) return std::unexpected(sequence.error());
    const auto rendered = render(options, *rig, *sequence, session.json);
    if (!rendered) return std::unexpected(rendered.error());
    session.warn(rendered->warnings);
    answer["captures"] = rendered->captures;
    text += rendered->text;
  }
  if (options.out.empty() && options.write_parts.empty())
    return failure(ResultCode::kUsage, "expected --out DIR, --write-parts DIR or --live, found none; see --help");
  session.answer(answer, text);
  return {};
}

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

Run add_simulate(CLI::App& app) {
  const auto options = std::make_shared<SimulateOptions>();
  app.add_option("--out", options->out, "folder of the capture; with --count of 000, 001, ...")->type_name("DIR");
  app.add_option("--scene", options->scene,
                 "paper:1..12, belt, bare, plane (of the belt, or --height-mm, --tilt-deg); calibration: plate, "
                 "plate-on-belt; known shapes: planes (spread by seed), sphere (a ball bar), steps (default belt)");
  app.add_option("--part", options->parts,
                 "knuckle, elbow, bracket, vblock or a mesh file; repeat to mix (default knuckle)");
  app.add_option("--mm-per-unit", options->mm_per_unit, "of mesh files (default 1)")->check(CLI::Range(1e-6, 1e6));
  app.add_option("--parts", options->parts_in_view,
                 "parts in view of a belt (default 3); live: on the belt (default 24)")
      ->check(CLI::Range(1, 100'000));
  app.add_option("--lay", options->lays, "how each of them lies: flat, edge, any, leaning, cut")
      ->delimiter(',')
      ->check(CLI::IsMember(kLays));
  app.add_option("--seed", options->seed, "of scene, surfaces and noise (default 1)");
  app.add_option("--count", options->count, "captures, seeds counting up (default 1)")->check(CLI::Range(1, 1000));
  app.add_option("--sequence", options->sequence, "fast, standard, robust or a sequence.json (default standard)");
  app.add_option("--axes", options->axes, "what a named sequence codes (default column; plates both)")
      ->check(CLI::IsMember(choices(kSequenceAxesNames)));
  app.add_option("--write-parts", options->write_parts, "write meshes and grasps of the parts")->type_name("DIR");
  add_rig_options(app, *options);
  add_light_options(app, *options);
  app.add_option(
      "--board", options->board,
      "plate: inner corners, columns x rows (default 11x8); live: what the trigger board is: emulated, the firmware's "
      "real ELF in an emulated microcontroller, or host, its core on this PC (default host)");
  add_target_options(app, options->targets);
  add_live_options(app, options->live);
  example(app,
          "  beltpick simulate --out scene --scene paper:5 --seed 7 --sequence standard\n"
          "  beltpick simulate --out plates --scene plate --board 11x8 --square-mm 20 --count 15 --seed 7\n"
          "  beltpick simulate --live --parts 24 --seed 7 --report report.json\n"
          "  beltpick simulate --write-parts parts --part knuckle --part elbow");
  return [options, &app](Session& session) { return run(*options, app, session); };
}

}  // namespace beltpick::cli
