// beltpick calibrate belt: where the belt is, from a capture of the bare belt.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "base/units.hpp"
#include "calibrate/belt_frame.hpp"
#include "calibrate_actions.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/file_io.hpp"
#include "options.hpp"
#include "segmented_input.hpp"

namespace beltpick::cli {
namespace {

using calibrate::BeltPlane;
using calibrate::BeltPose;
using contract_io::Json;

struct BeltOptions {
  SegmentChoices input;
  std::string out;
};

// The frame found, and what is told of it.
struct Found {
  BeltPose T_belt_camera;
  Json figures = Json::object();
  std::string words;
};

// The cell file that is there already. What its robot's pose was measured with must be the calibration of now.
Result<std::optional<Cell>> earlier_cell(const std::string& path, const Calibration& calibration) {
  if (!std::filesystem::exists(path)) return std::optional<Cell>{};
  contract_io::Warnings unknown_members;  // which stay
  auto cell = contract_io::read_cell(path, unknown_members);
  if (!cell) return std::unexpected(cell.error());
  if (cell->T_robot_camera && cell->calibration_id != calibration.id) {
    return failure(
        ResultCode::kCalibrationMismatch,
        "%s: robot_from_camera was measured with calibration '%s', this is '%s'; write to a new file by --out, "
        "then repeat the hand-eye calibration",
        contract_io::one_line(path).c_str(), cell->calibration_id.c_str(), calibration.id.c_str());
  }
  return std::optional<Cell>(*cell);
}

Result<Found> find_bare_belt(const BeltOptions& options, const std::optional<Cell>& earlier, Session& session) {
  const auto segmented = SegmentedInput::make(options.input, session);
  if (!segmented) return std::unexpected(segmented.error());
  const auto& objects = (*segmented)->objects();
  if (!objects.belt) {
    return failure(ResultCode::kNothingFound, "%s: no plane carries the view; capture the bare belt",
                   options.input.input.c_str());
  }
  if (!objects.segments.empty()) {
    session.warn({options.input.input + ": " + std::to_string(objects.segments.size()) +
                  " objects lie on the belt and are left out; a bare belt is measured best"});
  }
  const auto belt = calibrate::fit_belt_plane((*segmented)->input().range(), *objects.belt);
  if (!belt) return failure(belt.error().code, "%s: %s", options.input.input.c_str(), belt.error().detail);
  const bool kept = earlier && earlier->T_belt_camera;
  Found found;
  found.T_belt_camera = calibrate::belt_frame_on(belt->plane, kept ? earlier->T_belt_camera : std::nullopt);
  found.figures = {{"points", belt->points}, {"share_of_measured", belt->inlier_share},     {"rms_mm", belt->rms_mm},
                   {"bow_mm", belt->bow_mm}, {"objects_left_out", objects.segments.size()}, {"axes_kept", kept}};
  char line[300];
  std::snprintf(
      line, sizeof line,
      "plane through %d points (%.1f %% of those measured), %.3f mm rms, the belt's bow "
      "%.3f mm\n%s\n",
      belt->points, 100.0 * belt->inlier_share, belt->rms_mm, belt->bow_mm,
      kept ? "origin and x axis as they were in the cell file, laid onto the plane"
           : "a bare belt does not tell its direction of travel: x runs as the image's columns do, the origin is "
             "where the camera's axis meets the belt");
  found.words = line;
  return found;
}

std::string place_of(const BeltPose& T_belt_camera) {
  const Plane plane = calibrate::belt_plane_of(T_belt_camera);
  char line[160];
  std::snprintf(line, sizeof line,
                "belt %.3f mm from the camera along its axis, tilted %.3f degrees against its image\n",
                plane.offset_mm / plane.normal.z(), deg_from_rad(std::acos(std::min(1.0, std::abs(plane.normal.z())))));
  return line;
}

Result<void> run(const BeltOptions& options, Session& session) {
  contract_io::Warnings warnings;
  const auto calibration = contract_io::read_calibration(options.input.calibration, warnings);
  if (!calibration) return std::unexpected(calibration.error());
  const auto earlier = earlier_cell(options.out, *calibration);
  if (!earlier) return std::unexpected(earlier.error());
  const auto found = find_bare_belt(options, *earlier, session);
  if (!found) return std::unexpected(found.error());
  Cell cell;
  cell.calibration_id = calibration->id;
  cell.T_belt_camera = found->T_belt_camera;
  if (auto written = contract_io::update_cell(options.out, cell); !written) return written;
  Json answer = {{"cell", options.out},
                 {"calibration_id", calibration->id},
                 {"belt_from_camera", contract_io::json_matrix(found->T_belt_camera.matrix())}};
  answer.update(found->figures);
  session.answer(answer, options.out + ": " + place_of(found->T_belt_camera) + found->words);
  return {};
}

}  // namespace

Run add_calibrate_belt(CLI::App& app) {
  const auto options = std::make_shared<BeltOptions>();
  app.add_option("CAPTURE", options->input.input, "the bare belt")->required();
  app.add_option("--calibration", options->input.calibration, "of this camera and projector")
      ->required()
      ->type_name("calibration.json");
  app.add_option("--out", options->out, "the cell file; its other members stay where it is there already")
      ->required()
      ->type_name("cell.json");
  example(app, "  beltpick calibrate belt bare --calibration calibration.json --out cell.json");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
