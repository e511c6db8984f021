// The paper's experiment, rebuilt in the virtual cell: 12 scenes of three parts (its Figure 4), rendered, decoded and
// located; printed as its Table 1 a and b, with the distance to the surface and the true pose error beside it.
//   paper_experiment [SEED]     scenes of that seed (default 1)
// Parts are counted by what the camera sees of them, and by what the light reached too: a part in another's cast shadow
// is in view, but not measured. The paper's metric is the RMS distance of the object's points to the nearest of the
// template's 36,600 points; a part counts as located when it is verified. Ends with one line of JSON.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "bench/pose/machine.hpp"
#include "bench/pose/need.hpp"
#include "bench/pose/quantile.hpp"
#include "contract/pose_difference.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/npy_io.hpp"
#include "contract_io/template_io.hpp"
#include "contract_io/truth_io.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::bench {
namespace {

constexpr int kScenes = 12;

void run(const std::string& command) {
  if (std::system((std::string(BELTPICK_BIN_DIR) + "/beltpick " + command + " > /dev/null").c_str()) == 0) return;
  throw std::runtime_error("'beltpick " + command + "' failed");
}

// What is measured of one part.
struct Row {
  double visible = 0.0;   // share of the part in view of the camera
  double measured = 0.0;  // share of it that the light reached too, so that it was measured
  bool located = false;
  double search_mm = 0.0, icp_mm = 0.0;  // the paper's metric
  double surface_mm = 0.0;
  double error_mm = 0.0, error_deg = 0.0;
};

// Of the pixels that show a part, the share that was measured.
double measured_share(const RangeImage& range, ImageView<const std::uint16_t> instances, int part) {
  int seen = 0, measured = 0;
  for (int row = 0; row < instances.rows; ++row) {
    for (int col = 0; col < instances.cols; ++col) {
      if (instances(row, col) != part + 1) continue;
      ++seen;
      measured += range.valid(row, col) ? 1 : 0;
    }
  }
  return seen > 0 ? measured / static_cast<double>(seen) : 0.0;
}

// RMS distance to the nearest template point of what was measured of the part: object pixels that truly show it.
double paper_rms_mm(const pipeline::Located& located, const RangeImage& range, ImageView<const std::uint16_t> instances,
                    std::size_t part, const result::PartPose& T_camera_part, const PartModel& model) {
  const auto T_part_camera = T_camera_part.inverse();
  double square = 0.0;
  int count = 0;
  for (int row = 0; row < range.point_mm.rows; ++row) {
    for (int col = 0; col < range.point_mm.cols; ++col) {
      if (located.objects.labels(row, col) == 0 || instances(row, col) != part + 1 || !range.valid(row, col)) continue;
      const Vec3f at = (T_part_camera * range.point_mm(row, col).cast<double>()).cast<float>();
      square += (model.nearest(at).point_mm - at).squaredNorm();
      ++count;
    }
  }
  return count == 0 ? 0.0 : std::sqrt(square / count);
}

// The part of the truth that a found pose is nearest to.
std::size_t nearest_truth(const Truth& truth, const result::PartPose& pose, const PartModel& model) {
  std::size_t best = 0;
  double least = 1e9;
  for (std::size_t i = 0; i < truth.parts.size(); ++i) {
    const double apart = difference_modulo_symmetry(pose, truth.parts[i].T_camera_part, model).translation_mm;
    if (apart < least) least = apart, best = i;
  }
  return best;
}

RangeImage measure(Machine& machine, const std::filesystem::path& folder, const Calibration& calibration) {
  contract_io::Warnings warnings;
  auto reader = need(contract_io::CaptureReader::open(folder, warnings));
  need(machine.measure.configure(reader.header().sequence, calibration));
  need(machine.measure.begin());
  for (int i = 0; i < reader.frames(); ++i) need(machine.measure.fold(i, need(reader.image(i, warnings)).view8()));
  return need(machine.measure.finish());
}

std::vector<Row> run_scene(Machine& machine, const std::filesystem::path& folder, std::vector<double>& times_ms) {
  contract_io::Warnings warnings;
  const Calibration calibration = need(contract_io::read_calibration(folder / "calibration.json", warnings));
  const Truth truth = need(contract_io::read_truth(folder / "truth.json", warnings));
  const RangeImage range = measure(machine, folder, calibration);
  const auto located =
      need(machine.pipeline.locate({range, calibration.camera, pipeline::projector_position_mm(calibration), 1}));
  const double whole_ms =
      machine.measure.timing().decode_ms + machine.measure.timing().range_ms + located.segment_ms + located.locate_ms;
  times_ms.push_back(whole_ms / static_cast<double>(std::max<std::size_t>(1, located.found.parts.size())));
  auto shown = need(contract_io::read_npy<std::uint16_t>(folder / truth.instances_file, {-1, -1}));
  const ImageView<const std::uint16_t> instances{shown.values.data(), range.point_mm.rows, range.point_mm.cols};
  std::vector<Row> rows(truth.parts.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].visible = truth.parts[i].visible_fraction;
    rows[i].measured = rows[i].visible * measured_share(range, instances, static_cast<int>(i));
  }
  for (std::size_t i = 0; i < located.found.parts.size(); ++i) {
    const LocatedPart& part = located.found.parts[i];
    const PartModel& model = machine.pipeline.models().front();
    const std::size_t which = nearest_truth(truth, part.T_camera_part, model);
    const PoseDifference error =
        difference_modulo_symmetry(part.T_camera_part, truth.parts[which].T_camera_part, model);
    Row& row = rows[which];
    row.located = true;
    row.search_mm =
        paper_rms_mm(located, range, instances, which, located.found.candidates[i].hypothesis.T_camera_part, model);
    row.icp_mm = paper_rms_mm(located, range, instances, which, part.T_camera_part, model);
    row.surface_mm = part.rms_mm;
    row.error_mm = error.translation_mm;
    row.error_deg = deg_from_rad(error.rotation_rad);
  }
  return rows;
}

double median(const std::vector<double>& values) { return quantile(values, 0.5); }

void print_table(const char* title, const std::vector<std::vector<Row>>& scenes, double Row::*value,
                 const char* format) {
  std::printf("\n%s\n  #     CC1     CC2     CC3\n", title);
  for (std::size_t scene = 0; scene < scenes.size(); ++scene) {
    std::printf("%3zu", scene + 1);
    for (const Row& row : scenes[scene]) row.located ? std::printf(format, row.*value) : std::printf("     N/A");
    std::printf("\n");
  }
}

void report(const std::vector<std::vector<Row>>& scenes, const std::vector<double>& times_ms, unsigned seed) {
  print_table("a) RMS to the template's points after the search, mm", scenes, &Row::search_mm, "%8.2f");
  print_table("b) RMS to the template's points after ICP, mm", scenes, &Row::icp_mm, "%8.2f");
  print_table("RMS to the surface, mm", scenes, &Row::surface_mm, "%8.3f");
  print_table("True error of the position, mm", scenes, &Row::error_mm, "%8.3f");
  print_table("True error of the rotation, degrees", scenes, &Row::error_deg, "%8.3f");
  std::vector<double> search, icp, surface, error_mm, error_deg;
  int parts = 0, half_in_view = 0, missed = 0, half_measured = 0, missed_measured = 0, wrong = 0;
  for (const auto& rows : scenes) {
    for (const Row& row : rows) {
      ++parts;
      half_in_view += row.visible >= 0.5 ? 1 : 0;
      missed += row.visible >= 0.5 && !row.located ? 1 : 0;
      half_measured += row.measured >= 0.5 ? 1 : 0;
      missed_measured += row.measured >= 0.5 && !row.located ? 1 : 0;
      if (!row.located) std::printf("not located: %.2f in view, %.2f of it measured\n", row.visible, row.measured);
      if (!row.located) continue;
      wrong += row.error_mm > 1.0 || row.error_deg > 1.0 ? 1 : 0;
      search.push_back(row.search_mm), icp.push_back(row.icp_mm), surface.push_back(row.surface_mm);
      error_mm.push_back(row.error_mm), error_deg.push_back(row.error_deg);
    }
  }
  std::printf(
      "\n{\"seed\": %u, \"parts\": %d, \"half_in_view\": %d, \"located\": %zu, \"missed_half_in_view\": %d, "
      "\"half_measured\": %d, \"missed_half_measured\": %d, \"wrong\": %d, "
      "\"median_search_mm\": %.2f, \"median_icp_mm\": %.3f, \"median_surface_mm\": %.3f, \"median_error_mm\": %.4f, "
      "\"median_error_deg\": %.4f, \"median_ms_a_part\": %.1f}\n",
      seed, parts, half_in_view, icp.size(), missed, half_measured, missed_measured, wrong, median(search), median(icp),
      median(surface), median(error_mm), median(error_deg), median(times_ms));
}

void run(unsigned seed) {
  const test::TempFolder folder;
  const std::string at = folder.path().string();
  run("simulate --write-parts " + at + "/parts");
  run("teach " + at + "/parts/knuckle.stl --units mm --out " + at + "/knuckle.template");
  const std::vector<PartTemplate> templates{need(contract_io::read_template(at + "/knuckle.template"))};
  Machine machine{Limits{}};
  need(machine.pipeline.load(templates));
  std::vector<std::vector<Row>> scenes;
  std::vector<double> times_ms;
  for (int scene = 1; scene <= kScenes; ++scene) {
    const std::string to = at + "/" + std::to_string(scene);
    run("simulate --scene paper:" + std::to_string(scene) + " --seed " + std::to_string(seed) + " --out " + to);
    scenes.push_back(run_scene(machine, to, times_ms));
  }
  report(scenes, times_ms, seed);
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  try {
    beltpick::bench::run(argc > 1 ? static_cast<unsigned>(std::strtoul(argv[1], nullptr, 10)) : 1U);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "paper_experiment: %s\n", error.what());
    return 1;
  }
}
