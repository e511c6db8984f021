// beltpick simulate: scenes of the virtual cell written as CAPTURE folders with their truth.
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "simulate_stage.hpp"
#include "virtual_cell/render/capture_folder.hpp"
#include "virtual_cell/render/rig_calibration.hpp"

namespace beltpick::cli {
namespace {

namespace vc = virtual_cell;

constexpr int kMaxPartsInView = 12;
constexpr double kTargetBlurPx = 0.4;  // of a good lens with pixels of 3 to 5 micrometres

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
  const auto rig = chosen_rig(options, app);
  if (!rig) return std::unexpected(rig.error());
  auto sequence = chosen_sequence(options, *rig, session);
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
    const auto rig = chosen_rig(options, app);
    if (!rig) return std::unexpected(rig.error());
    const auto sequence = chosen_sequence(options, *rig, session);
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

}  // namespace

Run add_simulate(CLI::App& app) {
  const auto options = std::make_shared<SimulateOptions>();
  add_simulate_options(app, *options);
  example(app,
          "  beltpick simulate --out scene --scene paper:5 --seed 7 --sequence standard\n"
          "  beltpick simulate --out plates --scene plate --board 11x8 --square-mm 20 --count 15 --seed 7\n"
          "  beltpick simulate --out bars --scene sphere --ball-distance-mm 120 --count 5 --drift-px 0.3\n"
          "  beltpick simulate --live --parts 24 --seed 7 --report report.json\n"
          "  beltpick simulate --write-parts parts --part knuckle --part elbow");
  return [options, &app](Session& session) { return run(*options, app, session); };
}

}  // namespace beltpick::cli
