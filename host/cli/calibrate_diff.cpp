// beltpick calibrate diff: how far apart two calibrations measure.
#include <cstdio>
#include <memory>

#include "calibrate/compare.hpp"
#include "calibrate/compare_report.hpp"
#include "calibrate_actions.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "options.hpp"
#include "text_table.hpp"

namespace beltpick::cli {
namespace {

using calibrate::Comparison;
using calibrate::Spread;
using contract_io::Json;

struct DiffOptions {
  std::string old_file, new_file, cell, report;
  calibrate::CompareOptions compare;
  double distance_mm = 0.0;
};

Json to_json(const Spread& spread) {
  return {{"rms_mm", spread.rms_mm}, {"max_mm", spread.max_mm}, {"points", spread.points}};
}

Json to_json(const Comparison& comparison, const std::vector<calibrate::ParameterPair>& parameters) {
  Json rows = Json::array();
  for (const auto& row : parameters) {
    rows.push_back({{"name", row.name}, {"old", row.old_value}, {"new", row.new_value}});
  }
  return {
      {"axis", comparison.axis == Axis::kColumn ? "column" : "row"},
      {"belt_distance_mm", comparison.distance_mm},
      {"belt_distance_guessed", comparison.distance_guessed},
      {"height_mm", comparison.height_mm},
      {"as_they_stand", {{"belt", to_json(comparison.belt)}, {"volume", to_json(comparison.volume)}}},
      {"after_best_motion", {{"belt", to_json(comparison.belt_moved)}, {"volume", to_json(comparison.volume_moved)}}},
      {"motion",
       {{"rotation_deg", calibrate::motion_deg(comparison)},
        {"shift_mm", calibrate::motion_mm(comparison)},
        {"scale_ppm", 1e6 * (1.0 / comparison.motion.scale - 1.0)}}},
      {"parameters", rows}};
}

std::string millimetres(double value_mm) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4f", value_mm);
  return text;
}

std::string describe(const Comparison& comparison, const std::vector<calibrate::ParameterPair>& parameters) {
  std::string text = calibrate::verdict(comparison) + "\n\n";
  std::vector<std::vector<std::string>> rows{{"mm", "rms", "largest"}};
  const auto add = [&](const char* what, const Spread& spread) {
    rows.push_back({what, millimetres(spread.rms_mm), millimetres(spread.max_mm)});
  };
  add("as they stand, at the belt", comparison.belt);
  add("as they stand, in the volume", comparison.volume);
  add("after the best rigid motion, at the belt", comparison.belt_moved);
  add("after the best rigid motion, in the volume", comparison.volume_moved);
  text += text_table(rows) + "\n";
  rows = {{"parameter", "old", "new", "change"}};
  for (const auto& row : parameters) {
    char old_text[40], new_text[40], change[40];
    std::snprintf(old_text, sizeof old_text, "%.5f", row.old_value);
    std::snprintf(new_text, sizeof new_text, "%.5f", row.new_value);
    std::snprintf(change, sizeof change, "%+.5f", row.new_value - row.old_value);
    rows.push_back({row.name, old_text, new_text, change});
  }
  return text + text_table(rows);
}

Result<void> run(const DiffOptions& options, Session& session) {
  contract_io::Warnings warnings;
  const auto old_calibration = contract_io::read_calibration(options.old_file, warnings);
  if (!old_calibration) return std::unexpected(old_calibration.error());
  const auto new_calibration = contract_io::read_calibration(options.new_file, warnings);
  if (!new_calibration) return std::unexpected(new_calibration.error());
  std::optional<Cell> cell;
  if (!options.cell.empty()) {
    auto read = contract_io::read_cell(options.cell, warnings);
    if (!read) return std::unexpected(read.error());
    if (!read->T_belt_camera) {
      return failure(ResultCode::kMemberMissing,
                     "%s: belt_from_camera: expected where the belt is, found nothing; make "
                     "it by 'beltpick calibrate belt', or give --distance-mm",
                     options.cell.c_str());
    }
    cell = *read;
  }
  session.warn(warnings);
  calibrate::CompareOptions chosen = options.compare;
  if (options.distance_mm > 0.0) chosen.distance_mm = options.distance_mm;
  const auto comparison = calibrate::compare(*old_calibration, *new_calibration, cell, chosen);
  if (!comparison) return std::unexpected(comparison.error());
  const auto parameters = calibrate::parameters_of(*old_calibration, *new_calibration);
  if (!options.report.empty()) {
    const calibrate::ComparedFiles files{options.old_file, options.new_file};
    if (auto written = calibrate::write_compare_report(options.report, files, *comparison, parameters); !written) {
      return written;
    }
  }
  session.answer(to_json(*comparison, parameters), describe(*comparison, parameters));
  return {};
}

}  // namespace

Run add_calibrate_diff(CLI::App& app) {
  const auto options = std::make_shared<DiffOptions>();
  app.add_option("OLD", options->old_file, "calibration.json that is compared with")->required();
  app.add_option("NEW", options->new_file, "calibration.json of the same rig")->required();
  app.add_option("--cell", options->cell, "where the belt is")->type_name("cell.json");
  app.add_option("--distance-mm", options->distance_mm,
                 "of the belt from the camera, instead of --cell; default: where the centres of both images meet")
      ->check(CLI::Range(1.0, 1e5))
      ->excludes("--cell");
  app.add_option("--height-mm", options->compare.height_mm, "of the volume above the belt")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e4));
  app.add_option("--report", options->report, "write index.html with maps of the difference")->type_name("DIR");
  example(app,
          "  beltpick calibrate diff old.json new.json --cell cell.json\n"
          "  beltpick calibrate diff old.json new.json --distance-mm 700 --report compared");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
