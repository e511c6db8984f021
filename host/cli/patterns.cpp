// beltpick patterns: the images that the projector shows, and sequence.json.
#include <array>
#include <memory>

#include "commands.hpp"
#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace beltpick::cli {
namespace {

constexpr std::array<std::string_view, 2> kLayouts{"square", "diamond"};  // in the order of the enumerators

struct PatternOptions {
  std::string projector;
  std::string layout = "square";
  std::string sequence = "standard";
  std::string axes = "column";
  std::string out;
  bool explain = false;
};

std::vector<std::uint8_t> draw(const FrameSpec& frame, const ProjectorGrid& projector) {
  const std::size_t width = static_cast<std::size_t>(projector.width);
  std::vector<std::uint8_t> pixels(width * static_cast<std::size_t>(projector.height));
  for (int row = 0; row < projector.height; ++row) {
    for (int column = 0; column < projector.width; ++column) {
      const double x = lattice_coordinate(projector.layout, frame.axis, row, column);
      const auto level = static_cast<std::uint8_t>(255.0 * pattern_intensity(frame, x) + 0.5);
      pixels[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)] = level;
    }
  }
  return pixels;
}

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
  Progress progress("patterns", static_cast<int>(sequence.frames.size()), quiet);
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const FrameSpec& frame = sequence.frames[i];
    const std::vector<std::uint8_t> pixels = draw(frame, sequence.projector);
    const ImageView<const std::uint8_t> image(pixels.data(), sequence.projector.height, sequence.projector.width);
    if (const auto written = contract_io::write_png(folder / frame.file, image); !written) return written;
    progress.show(static_cast<int>(i) + 1);
  }
  return contract_io::write_sequence(folder / "sequence.json", sequence);
}

Result<void> run(const PatternOptions& options, Session& session) {
  const auto size = parse_size(options.projector, "--projector");
  if (!size) return std::unexpected(size.error());
  const ProjectorGrid grid{size->width, size->height, enum_of<ProjectorLayout>(options.layout, kLayouts)};
  const auto sequence = make_sequence(enum_of<SequenceName>(options.sequence, kSequenceNames), grid,
                                      enum_of<SequenceAxes>(options.axes, kSequenceAxesNames));
  if (!sequence) return std::unexpected(sequence.error());
  if (const auto written = write_images(*sequence, options.out, session.json); !written) return written;

  std::string text;
  for (const FrameSpec& frame : sequence->frames) text += options.explain ? explain(frame) : "";
  text += options.out + ": " + std::to_string(sequence->frames.size()) + " patterns of " + options.projector +
          " pixels and sequence.json\n";
  session.answer({{"out", options.out}, {"frames", sequence->frames.size()}}, text);
  return {};
}

}  // namespace

Run add_patterns(CLI::App& app) {
  const auto options = std::make_shared<PatternOptions>();
  app.add_option("--projector", options->projector, "the projector's size in pixels, e.g. 912x1140")->required();
  app.add_option("--sequence", options->sequence, "fewer or more frames (default standard)")
      ->check(CLI::IsMember(choices(kSequenceNames)));
  app.add_option("--axes", options->axes, "what to code of a projector's pixel (default column)")
      ->check(CLI::IsMember(choices(kSequenceAxesNames)));
  app.add_option("--layout", options->layout, "the projector's lattice (default square)")
      ->check(CLI::IsMember(choices(kLayouts)));
  app.add_option("--out", options->out, "folder for 000.png ... and sequence.json")->required()->type_name("DIR");
  app.add_flag("--explain", options->explain, "list what every frame shows");
  example(app, "  beltpick patterns --projector 912x1140 --sequence standard --axes column --out patterns");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
