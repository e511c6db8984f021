// beltpick calibrate verify: one capture of the plate tells whether a calibration still holds.
#include <cstdio>
#include <memory>

#include "calibrate/check_report.hpp"
#include "calibrate_actions.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "measured_plate.hpp"
#include "options.hpp"
#include "text_table.hpp"

namespace beltpick::cli {
namespace {

using calibrate::CheckedFigure;
using calibrate::PlateCheck;
using contract_io::Json;

struct VerifyOptions {
  std::string capture, calibration, report;
  BoardOptions board;
  calibrate::PlateTolerance tolerance;
};

std::string three_decimals(double value_mm) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f", value_mm);
  return text;
}

Json to_json(const PlateCheck& check, const Calibration& calibration) {
  Json figures = Json::array();
  for (const CheckedFigure& figure : check.figures) {
    figures.push_back(
        {{"name", figure.name}, {"value_mm", figure.value_mm}, {"limit_mm", figure.limit_mm}, {"good", figure.good()}});
  }
  return {{"calibration_id", calibration.id},
          {"good", check.good()},
          {"verdict", check.verdict()},
          {"corners", check.corners.size()},
          {"distance_mm", check.distance_mm},
          {"tilt_deg", check.tilt_deg},
          {"size_error_mm", check.size_error_mm},
          {"distance_error_mm", check.distance_error_mm},
          {"camera_rms_px", check.camera_rms_px},
          {"projector_rms_px", check.projector_rms_px},
          {"projector_shift_px", {check.projector_shift_px.column_px, check.projector_shift_px.row_px}},
          {"figures", figures}};
}

std::string describe(const PlateCheck& check) {
  char line[300];
  std::snprintf(line, sizeof line, "%zu corners, the plate %.0f mm away, tilted by %.0f degrees\n\n",
                check.corners.size(), check.distance_mm, check.tilt_deg);
  std::vector<std::vector<std::string>> rows{{"mm", "measured", "at most", ""}};
  for (const CheckedFigure& figure : check.figures) {
    rows.push_back({figure.meaning, three_decimals(figure.value_mm), three_decimals(figure.limit_mm),
                    figure.good() ? "good" : "TOO MUCH"});
  }
  std::string text = line + text_table(rows);
  std::snprintf(
      line, sizeof line,
      "\nsize %+.3f mm and distance %+.3f mm (measured - true); the projector's light lies %+.2f columns, %+.2f "
      "rows from where the calibration has it\n",
      check.size_error_mm, check.distance_error_mm, check.projector_shift_px.column_px,
      check.projector_shift_px.row_px);
  return text + line + check.verdict() + "\n";
}

Result<void> run(const VerifyOptions& options, Session& session) {
  contract_io::Warnings warnings;
  const auto calibration = contract_io::read_calibration(options.calibration, warnings);
  if (!calibration) return std::unexpected(calibration.error());
  const auto check =
      measure_plate(options.capture, options.board, *calibration, options.tolerance, warnings, session.json);
  session.warn(warnings);
  if (!check) return std::unexpected(check.error());
  if (!options.report.empty()) {
    const calibrate::CheckedFiles files{options.capture, options.calibration};
    if (auto written = calibrate::write_check_report(options.report, files, *check, options.board.square_mm);
        !written) {
      return written;
    }
  }
  session.answer(to_json(*check, *calibration), describe(*check));
  if (check->good()) return {};
  return failure(ResultCode::kCheckFailed, "%s: %s; let the cell warm up and check again, then calibrate anew",
                 options.capture.c_str(), check->verdict().c_str());
}

}  // namespace

Run add_calibrate_verify(CLI::App& app) {
  const auto options = std::make_shared<VerifyOptions>();
  app.add_option("CAPTURE", options->capture, "the plate, of both axes")->required();
  app.add_option("--calibration", options->calibration, "that is checked")->required()->type_name("calibration.json");
  add_board_options(app, options->board);
  app.add_option("--local-mm", options->tolerance.local_mm,
                 "tolerance from corner to corner, rms: their distances, and how far they are out of one plane")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 100.0));
  app.add_option("--plate-mm", options->tolerance.plate_mm,
                 "tolerance over the plate: its size, its bow, its distance, where camera and projector see it")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 100.0));
  app.add_option("--report", options->report, "write index.html with the figures and pictures of the plate")
      ->type_name("DIR");
  example(
      app,
      "  beltpick calibrate verify check --calibration calibration.json --board 11x8 --square-mm 20\n"
      "  beltpick calibrate verify check --calibration calibration.json --board 11x8 --square-mm 20 --report checked\n"
      "Ends with 0 when the calibration is in tolerance, else with 1.");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
