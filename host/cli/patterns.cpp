// beltpick patterns: the images that the projector shows, sequence.json, and the flash images of a LightCrafter 4500.
#include <array>
#include <memory>

#include "commands.hpp"
#include "contract/flash_plan.hpp"
#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/json_writer.hpp"
#include "options.hpp"
#include "pattern_images.hpp"
#include "progress.hpp"

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

Result<void> run(const PatternOptions& options, Session& session) {
  const auto grid = read_grid(options);
  if (!grid) return std::unexpected(grid.error());
  auto sequence = make_sequence(enum_of<SequenceName>(options.sequence, kSequenceNames), *grid,
                                enum_of<SequenceAxes>(options.axes, kSequenceAxesNames));
  if (!sequence) return std::unexpected(sequence.error());
  contract_io::Json answer = {{"out", options.out}, {"frames", sequence->frames.size()}};
  std::string about_flash;
  if (options.lcr4500) {
    const auto flash = lcr4500::plan_flash(*sequence);
    if (!flash) return std::unexpected(flash.error());
    sequence->flash = flash->places;
    answer["flash"] = flash_answer(*flash);
    about_flash = flash_text(*sequence, *flash);
  }
  if (const auto written = write_images(*sequence, options.out, session.json); !written) return written;
  const std::string size = std::to_string(grid->width) + "x" + std::to_string(grid->height);
  session.answer(answer, (options.explain ? explain(*sequence) : "") + options.out + ": " +
                             std::to_string(sequence->frames.size()) + " patterns of " + size +
                             " pixels and sequence.json\n" + about_flash);
  return {};
}

}  // namespace

Run add_patterns(CLI::App& app) {
  const auto options = std::make_shared<PatternOptions>();
  app.add_option("--projector", options->projector, "the projector's size in pixels, e.g. 912x1140");
  app.add_option("--sequence", options->sequence, "fewer or more frames (default standard)")
      ->check(CLI::IsMember(choices(kSequenceNames)));
  app.add_option("--axes", options->axes, "what to code of a projector's pixel (default column)")
      ->check(CLI::IsMember(choices(kSequenceAxesNames)));
  app.add_option("--layout", options->layout, "the projector's lattice (default square)")
      ->check(CLI::IsMember(choices(kLayouts)));
  app.add_flag(
      "--lcr4500", options->lcr4500,
      "for a LightCrafter 4500: also the 24-bit images for its flash, and in sequence.json where each frame lies");
  app.add_option("--out", options->out, "folder for 000.png ... and sequence.json")->required()->type_name("DIR");
  app.add_flag("--explain", options->explain, "list what every frame shows");
  example(app,
          "  beltpick patterns --projector 912x1140 --sequence standard --axes column --out patterns\n"
          "  beltpick patterns --lcr4500 --sequence fast --out patterns");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
