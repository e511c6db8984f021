// beltpick patterns: the images that the projector shows, sequence.json, and the flash images of a LightCrafter 4500.
#include <array>
#include <memory>

#include "commands.hpp"
#include "contract/exposures.hpp"
#include "contract/flash_plan.hpp"
#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/json_writer.hpp"
#include "options.hpp"
#include "pattern_images.hpp"
#include "progress.hpp"
#include "sequence_forecast.hpp"

namespace beltpick::cli {
namespace {

constexpr std::array<std::string_view, 2> kLayouts{"square", "diamond"};  // in the order of the enumerators

struct PatternOptions {
  std::string projector;
  std::string layout;
  std::string sequence = "standard";
  std::string axes = "column";
  std::string out;
  bool explain = false;
  bool lcr4500 = false;
  FrameTiming timing;
  std::string calibration;
  double distance_mm = 0.0;
  std::vector<double> exposures_us;
};

std::string explain(const FrameSpec& frame) {
  char line[160];
  const char* axis = frame.axis == Axis::kColumn ? "column" : "row";
  switch (frame.kind) {
    case FrameKind::kWhite:
      std::snprintf(line, sizeof line, "%s  white\n", frame.file.c_str());
      break;
    case FrameKind::kBlack:
      std::snprintf(line, sizeof line, "%s  black\n", frame.file.c_str());
      break;
    case FrameKind::kPhase:
      std::snprintf(line, sizeof line, "%s  phase  %-6s  period %g px, step %d of %d\n", frame.file.c_str(), axis,
                    frame.period_px, frame.step, frame.steps);
      break;
    case FrameKind::kGray:
      std::snprintf(line, sizeof line, "%s  gray   %-6s  cell %g px, bit %d%s\n", frame.file.c_str(), axis,
                    frame.cell_px, frame.bit, frame.inverted ? ", inverted" : "");
      break;
  }
  return line;
}

Result<void> write_images(const Sequence& sequence, const std::filesystem::path& folder, bool quiet) {
  if (const auto made = contract_io::make_folder(folder); !made) return made;
  const auto flash = sequence.flash.empty() ? Result<lcr4500::FlashPlan>() : lcr4500::plan_flash(sequence);
  if (!flash) return std::unexpected(flash.error());
  Progress progress("patterns", static_cast<int>(sequence.frames.size()) + flash->images, quiet);
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const FrameSpec& frame = sequence.frames[i];
    const std::vector<std::uint8_t> pixels = draw_pattern(frame, sequence.projector);
    const ImageView<const std::uint8_t> image(pixels.data(), sequence.projector.height, sequence.projector.width);
    if (const auto written = contract_io::write_png(folder / frame.file, image); !written) return written;
    progress.show(static_cast<int>(i) + 1);
  }
  if (const auto written = write_flash_images(sequence, *flash, folder, progress); !written) return written;
  return contract_io::write_sequence(folder / "sequence.json", sequence);
}

// The projector that the options describe. Error: kUsage.
Result<ProjectorGrid> read_grid(const PatternOptions& options) {
  if (options.lcr4500) {
    const std::string size = std::to_string(lcr4500::kWidth) + "x" + std::to_string(lcr4500::kHeight);
    if ((options.projector.empty() || options.projector == size) && options.layout != kLayouts[0]) {
      return ProjectorGrid{lcr4500::kWidth, lcr4500::kHeight, ProjectorLayout::kDiamond};
    }
    return failure(ResultCode::kUsage,
                   "--lcr4500: expected its %s pixels on a diamond lattice, found %s %s; leave "
                   "--projector and --layout out",
                   size.c_str(), options.projector.c_str(), options.layout.c_str());
  }
  if (options.projector.empty()) {
    return failure(ResultCode::kUsage,
                   "--projector: expected the projector's size, e.g. 912x1140, or --lcr4500, found "
                   "neither; see --help");
  }
  const auto size = parse_size(options.projector, "--projector");
  if (!size) return std::unexpected(size.error());
  const std::string layout = options.layout.empty() ? std::string(kLayouts[0]) : options.layout;
  return ProjectorGrid{size->width, size->height, enum_of<ProjectorLayout>(layout, kLayouts)};
}

std::string explain(const Sequence& sequence) {
  std::string text;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    text += explain(sequence.frames[i]);
    if (sequence.flash.empty()) continue;
    text.pop_back();
    text += "  in " + lcr4500::image_file(sequence.flash[i].image) + " " + plane_text(sequence.flash[i]) + "\n";
  }
  return text;
}

contract_io::Json flash_answer(const lcr4500::FlashPlan& flash) {
  contract_io::Json images = contract_io::Json::array();
  for (int i = 0; i < flash.images; ++i) images.push_back(lcr4500::image_file(i));
  return {{"images", images},
          {"planes", flash.planes},
          {"images_loaded_during_capture", flash.later_images()},
          {"load_ms", flash.load_us() / 1000}};
}

// A sequence file's frames, named as `beltpick patterns` names them. Error: kCalibrationMismatch where the options tell
// of another projector, besides those of the file.
Result<Sequence> read_frames(const PatternOptions& options, const Session& session) {
  if (!std::filesystem::exists(options.sequence)) {
    return failure(ResultCode::kFileNotFound,
                   "--sequence: expected fast, standard, robust, micro or a sequence.json, found '%s'; check the path",
                   contract_io::one_line(options.sequence).substr(0, 200).c_str());
  }
  contract_io::Warnings warnings;
  auto sequence = contract_io::read_sequence(options.sequence, warnings);
  session.warn(warnings);
  if (!sequence || (options.projector.empty() && options.layout.empty() && !options.lcr4500)) return sequence;
  PatternOptions asked = options;
  const ProjectorGrid& found = sequence->projector;
  if (asked.projector.empty() && !asked.lcr4500) {
    asked.projector = std::to_string(found.width) + "x" + std::to_string(found.height);
  }
  const auto grid = read_grid(asked);
  if (!grid) return std::unexpected(grid.error());
  const bool same_layout = (asked.layout.empty() && !asked.lcr4500) || grid->layout == found.layout;
  if (grid->width == found.width && grid->height == found.height && same_layout) return sequence;
  return failure(ResultCode::kCalibrationMismatch,
                 "%s: projector: expected %dx%d %s as the options say, found %dx%d %s; leave --projector, --layout and "
                 "--lcr4500 out or correct them",
                 options.sequence.c_str(), grid->width, grid->height,
                 kLayouts[static_cast<std::size_t>(grid->layout)].data(), found.width, found.height,
                 kLayouts[static_cast<std::size_t>(found.layout)].data());
}

Result<Sequence> find_base_frames(const PatternOptions& options, const Session& session) {
  const auto named = find_sequence_name(options.sequence);
  if (!named) return read_frames(options, session);
  const auto grid = read_grid(options);
  if (!grid) return std::unexpected(grid.error());
  return make_sequence(*named, *grid, enum_of<SequenceAxes>(options.axes, kSequenceAxesNames));
}

Result<Sequence> find_frames(const PatternOptions& options, const Session& session) {
  auto sequence = find_base_frames(options, session);
  return sequence && !options.exposures_us.empty() ? at_exposures(*sequence, options.exposures_us) : sequence;
}

Result<SequenceForecast> make_forecast(const PatternOptions& options, const Sequence& sequence, double load_us,
                                       const Session& session) {
  if (options.calibration.empty()) {
    const auto at = default_working_point(sequence.projector);
    return at ? forecast(sequence, options.timing, load_us, *at) : std::unexpected(at.error());
  }
  contract_io::Warnings warnings;
  const auto calibration = contract_io::read_calibration(options.calibration, warnings);
  session.warn(warnings);
  if (!calibration) return std::unexpected(calibration.error());
  const Lens& lens = calibration->projector;
  if (lens.width != sequence.projector.width || lens.height != sequence.projector.height) {
    return failure(ResultCode::kCalibrationMismatch,
                   "%s: projector: expected the sequence's %dx%d, found %dx%d; use the calibration of this projector",
                   options.calibration.c_str(), sequence.projector.width, sequence.projector.height, lens.width,
                   lens.height);
  }
  const auto at = working_point(*calibration, options.distance_mm);
  return at ? forecast(sequence, options.timing, load_us, *at) : std::unexpected(at.error());
}

// What is told of a sequence: for machines, for a person, and for a person who asked to have it explained.
struct Told {
  contract_io::Json json;
  std::string flash;
  std::string explained;
};

Result<Told> describe(const PatternOptions& options, Sequence& sequence, const Session& session) {
  Told told{{{"out", options.out}, {"frames", sequence.frames.size()}}, "", ""};
  double load_us = 0.0;
  if (options.lcr4500) {
    const auto flash = lcr4500::plan_flash(sequence);
    if (!flash) return std::unexpected(flash.error());
    sequence.flash = flash->places;
    load_us = flash->load_us();
    told.json["flash"] = flash_answer(*flash);
    told.flash = flash_text(sequence, *flash);
  }
  if (!options.explain) return told;
  const auto predicted = make_forecast(options, sequence, load_us, session);
  if (!predicted) return std::unexpected(predicted.error());
  told.json["explain"] = forecast_json(*predicted, options.timing);
  told.explained = explain(sequence) + forecast_text(*predicted, options.timing);
  return told;
}

Result<void> run(const PatternOptions& options, Session& session) {
  if (options.out.empty() && !options.explain) {
    return failure(ResultCode::kUsage, "expected --out DIR for the images, or --explain, found neither; see --help");
  }
  auto sequence = find_frames(options, session);
  if (!sequence) return std::unexpected(sequence.error());
  const auto told = describe(options, *sequence, session);
  if (!told) return std::unexpected(told.error());
  std::string person = told->explained;
  if (!options.out.empty()) {
    if (const auto written = write_images(*sequence, options.out, session.json); !written) return written;
    person += options.out + ": " + std::to_string(sequence->frames.size()) + " patterns of " +
              std::to_string(sequence->projector.width) + "x" + std::to_string(sequence->projector.height) +
              " pixels and sequence.json\n";
  }
  session.answer(told->json, person + told->flash);
  return {};
}

}  // namespace

Run add_patterns(CLI::App& app) {
  const auto options = std::make_shared<PatternOptions>();
  app.add_option("--projector", options->projector, "the projector's size in pixels, e.g. 912x1140");
  app.add_option("--sequence", options->sequence,
                 "fast, standard, robust, micro or a sequence.json (default standard)");
  app.add_option("--axes", options->axes, "what to code of a projector's pixel (default column)")
      ->check(CLI::IsMember(choices(kSequenceAxesNames)));
  app.add_option("--exposures-us", options->exposures_us,
                 "HDR: the sequence once at each of these exposures, e.g. 2000,8000,24000")
      ->delimiter(',')
      ->check(CLI::Range(1.0, 1e7));
  app.add_option("--layout", options->layout, "the projector's lattice (default square)")
      ->check(CLI::IsMember(choices(kLayouts)));
  app.add_flag(
      "--lcr4500", options->lcr4500,
      "for a LightCrafter 4500: also the 24-bit images for its flash, and in sequence.json where each frame lies");
  app.add_option("--out", options->out, "folder for 000.png ... and sequence.json")->type_name("DIR");
  app.add_flag("--explain", options->explain,
               "list what every frame shows, how long that takes, what memory decoding takes and what noise to expect");
  app.add_option("--projector-hz", options->timing.projector_hz, "explain: frames that it shows a second (default 60)")
      ->check(CLI::Range(0.01, 1e5));
  app.add_option("--exposure-us", options->timing.exposure_us, "explain: of the camera, a frame (default 8000)")
      ->check(CLI::Range(1.0, 1e7));
  app.add_option("--calibration", options->calibration, "explain: of the rig (default: the virtual cell's rig)")
      ->type_name("FILE");
  app.add_option("--distance-mm", options->distance_mm,
                 "explain: camera to object, with --calibration (default: where camera and projector meet)")
      ->check(CLI::Range(1.0, 1e5));
  example(app,
          "  beltpick patterns --projector 912x1140 --sequence standard --axes column --out patterns\n"
          "  beltpick patterns --lcr4500 --sequence fast --out patterns\n"
          "  beltpick patterns --sequence patterns/sequence.json --explain --projector-hz 120 --calibration cal.json");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
