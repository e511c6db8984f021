// Where the time of locating goes: the same captures located again and again, beside what came out of it.
//   locate_speed [--workers N] [--repeat N] [--tree] TEMPLATE... CAPTURE...
// Prints for each capture what each stage took (the median over the repeats) and what was found, with its true error
// where the capture has its truth, and a digest of all poses: what changes no result leaves it as it is. `--tree`
// looks up nearest points in the k-d tree instead of the grid. Ends with one line of JSON.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/template_io.hpp"
#include "contract_io/truth_io.hpp"
#include "pipeline/measure.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::bench {
namespace {

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "locate_speed: %s\n", result.error().detail);
  std::exit(1);
}
void need(const Result<void>& result) {
  if (result) return;
  std::fprintf(stderr, "locate_speed: %s\n", result.error().detail);
  std::exit(1);
}

struct Options {
  int workers = 1;
  int repeat = 9;
  bool tree = false;
  std::vector<PartTemplate> templates;
  std::vector<std::filesystem::path> captures;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--workers" && i + 1 < argc) {
      options.workers = std::atoi(argv[++i]);
    } else if (argument == "--repeat" && i + 1 < argc) {
      options.repeat = std::atoi(argv[++i]);
    } else if (argument == "--tree") {
      options.tree = true;
    } else if (argument.ends_with(".template")) {
      options.templates.push_back(need(contract_io::read_template(argument)));
    } else {
      options.captures.emplace_back(argument);
    }
  }
  return options;
}

double share_of(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}
double median(const std::vector<double>& values) { return share_of(values, 0.5); }

// FNV-1a over the bits of the poses.
void digest(std::uint64_t& hash, const result::PartPose& pose) {
  const Mat4 matrix = pose.matrix();
  for (int i = 0; i < 16; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, matrix.data() + i, sizeof bits);
    hash = (hash ^ bits) * 1099511628211ULL;
  }
}

struct Tally {
  std::vector<double> object_ms, locate_ms, whole_ms;
  int found = 0, expected = 0, wrong = 0;
  std::uint64_t hash = 14695981039346656037ULL;
};

void print_found(const pipeline::Located& located, const Truth& truth, std::span<const PartModel> models,
                 const Options& options, Tally& tally) {
  for (const LocatedPart& part : located.found.parts) {
    const auto index = static_cast<std::size_t>(part.template_index);
    PoseDifference least{1e9, 0.0};
    for (const TruePart& other : truth.parts) {
      if (other.part != options.templates[index].name) continue;
      const PoseDifference d = difference_modulo_symmetry(part.T_camera_part, other.T_camera_part, models[index]);
      if (d.translation_mm < least.translation_mm) least = d;
    }
    const bool wrong = least.translation_mm > 1.0 || deg_from_rad(least.rotation_rad) > 1.0;
    tally.wrong += wrong ? 1 : 0;
    digest(tally.hash, part.T_camera_part);
    std::printf("    %-10s segment %2d  %.4f mm %.4f deg  rms %.3f coverage %.2f%s\n",
                options.templates[index].name.c_str(), part.segment, least.translation_mm,
                deg_from_rad(least.rotation_rad), part.rms_mm, part.coverage, wrong ? "  WRONG" : "");
  }
  for (const WithheldObject& object : located.found.withheld) {
    std::printf("    segment %2d withheld: %s\n", object.segment, object.reason.detail);
  }
  tally.found += static_cast<int>(located.found.parts.size());
  for (const TruePart& part : truth.parts) tally.expected += part.visible_fraction >= 0.5 ? 1 : 0;
}

void run(pipeline::Measure& measure, pipeline::Pipeline& pipeline, const std::filesystem::path& folder,
         const Options& options, Tally& tally) {
  contract_io::Warnings warnings;
  const Calibration calibration = need(contract_io::read_calibration(folder / "calibration.json", warnings));
  auto reader = need(contract_io::CaptureReader::open(folder, warnings));
  need(measure.configure(reader.header().sequence, calibration));
  need(measure.begin());
  for (int i = 0; i < reader.frames(); ++i) need(measure.fold(i, need(reader.image(i, warnings)).view8()));
  const RangeImage range = need(measure.finish());
  const double measure_ms = measure.timing().decode_ms + measure.timing().range_ms;
  std::vector<double> segment_ms, locate_ms;
  std::vector<std::vector<double>> objects_ms;
  pipeline::Located located;
  for (int i = 0; i < options.repeat; ++i) {
    located = need(pipeline.locate({range, calibration.camera, pipeline::projector_position_mm(calibration), 1}));
    segment_ms.push_back(located.segment_ms);
    locate_ms.push_back(located.locate_ms);
    objects_ms.resize(located.found.object_ms.size());
    for (std::size_t k = 0; k < objects_ms.size(); ++k) objects_ms[k].push_back(located.found.object_ms[k]);
  }
  std::printf("%s: measure %.1f ms, segment %.1f, locate %.1f; objects", folder.filename().c_str(), measure_ms,
              median(segment_ms), median(locate_ms));
  for (const auto& of_one : objects_ms) {
    std::printf(" %.1f", median(of_one));
    tally.object_ms.push_back(median(of_one));
  }
  std::printf("\n");
  tally.locate_ms.push_back(median(locate_ms));
  tally.whole_ms.push_back(measure_ms + median(segment_ms) + median(locate_ms));
  const auto truth = contract_io::read_truth(folder / "truth.json", warnings);
  print_found(located, truth ? *truth : Truth{}, pipeline.models(), options, tally);
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  using namespace beltpick;
  const bench::Options options = bench::parse(argc, argv);
  Limits limits;
  if (options.tree) limits.grid_cells = 0;
  limits.templates = std::max<int>(limits.templates, static_cast<int>(options.templates.size()));
  Arena measuring;
  {
    const pipeline::Measure measure(measuring, pipeline::decoder_limits(limits));
    const pipeline::Pipeline pipeline(measuring, limits, options.workers);
  }
  const ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  pipeline::Measure measure(arena, pipeline::decoder_limits(limits));
  pipeline::Pipeline pipeline(arena, limits, options.workers);
  bench::need(pipeline.load(options.templates));
  bench::Tally tally;
  for (const auto& folder : options.captures) bench::run(measure, pipeline, folder, options, tally);
  std::printf(
      "{\"found\": %d, \"half_in_view\": %d, \"wrong\": %d, \"object_ms\": %.1f, \"object_p99_ms\": %.1f, "
      "\"locate_ms\": %.1f, \"from_last_frame_ms\": %.1f, \"digest\": \"%016llx\"}\n",
      tally.found, tally.expected, tally.wrong, bench::median(tally.object_ms), bench::share_of(tally.object_ms, 0.99),
      bench::median(tally.locate_ms), bench::median(tally.whole_ms), static_cast<unsigned long long>(tally.hash));
  return 0;
}
