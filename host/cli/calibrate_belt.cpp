// beltpick calibrate belt: where the belt is, from a capture of the bare belt or of the plate lying on it.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "base/units.hpp"
#include "calibrate/belt_frame.hpp"
#include "calibrate_actions.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/file_io.hpp"
#include "measured_plate.hpp"
#include "options.hpp"
#include "segmented_input.hpp"

namespace beltpick::cli {
namespace {

using calibrate::BeltPlane;
using calibrate::BeltPose;
using contract_io::Json;

constexpr double kThicknessTolerance_mm = 0.3;

struct BeltOptions {
  SegmentChoices input;
  BoardOptions board;
  double plate_thickness_mm = 0.0;
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

// Where the plate's face lies above the belt that is seen round it; nothing where too little of it is seen.
std::optional<double> height_above_belt_mm(const BeltOptions& options, const calibrate::PlateCheck& check,
                                           Session& session) {
  const auto segmented = SegmentedInput::make(options.input, session);
  if (!segmented || !(*segmented)->objects().belt) return std::nullopt;
  const auto belt = calibrate::fit_belt_plane((*segmented)->input().range(), *(*segmented)->objects().belt);
  if (!belt) return std::nullopt;
  double sum_mm = 0.0;
  for (const calibrate::MeasuredCorner& corner : check.corners) sum_mm += belt->plane.height_mm(corner.point_mm);
  const double height_mm = sum_mm / static_cast<double>(check.corners.size());
  constexpr double kOnThePlate_mm = 0.5;  // it is the plate's own face that carries the view
  return height_mm > kOnThePlate_mm ? std::optional(height_mm) : std::nullopt;
}

Result<Found> find_plate_on_belt(const BeltOptions& options, const Calibration& calibration, Session& session) {
  contract_io::Warnings warnings;
  const auto check = measure_plate(options.input.input, options.board, calibration, {}, warnings, session.json);
  if (!check) return std::unexpected(check.error());
  if (!check->good()) warnings.push_back(options.input.input + ": the calibration no longer fits: " + check->verdict());
  const auto height_mm = height_above_belt_mm(options, *check, session);
  char line[300];
  if (height_mm && std::abs(*height_mm - options.plate_thickness_mm) > kThicknessTolerance_mm) {
    std::snprintf(
        line, sizeof line,
        "%s: the plate's face lies %.2f mm above the belt seen round it, its thickness was given as %.2f mm; does "
        "it lie flat?",
        options.input.input.c_str(), *height_mm, options.plate_thickness_mm);
    warnings.emplace_back(line);
  }
  session.warn(warnings);
  Found found;
  found.T_belt_camera = calibrate::belt_frame_from(check->T_camera_plate, options.plate_thickness_mm);
  found.figures = {{"corners", check->corners.size()},
                   {"calibration_in_tolerance", check->good()},
                   {"height_above_belt_mm", height_mm ? Json(*height_mm) : Json()}};
  std::snprintf(
      line, sizeof line,
      "origin below the plate's first inner corner, x along its columns, z up, from %zu corners of the plate\n",
      check->corners.size());
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
  if (options.board.size.empty() != (options.plate_thickness_mm <= 0.0)) {
    return failure(ResultCode::kUsage,
                   "--board and --plate-thickness-mm belong together: the plate on the belt, or neither "
                   "for the bare belt");
  }
  contract_io::Warnings warnings;
  const auto calibration = contract_io::read_calibration(options.input.calibration, warnings);
  if (!calibration) return std::unexpected(calibration.error());
  const auto earlier = earlier_cell(options.out, *calibration);
  if (!earlier) return std::unexpected(earlier.error());
  const auto found = options.board.size.empty() ? find_bare_belt(options, *earlier, session)
                                                : find_plate_on_belt(options, *calibration, session);
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
  app.add_option("CAPTURE", options->input.input, "the bare belt, or with --board the plate on it")->required();
  app.add_option("--calibration", options->input.calibration, "of this camera and projector")
      ->required()
      ->type_name("calibration.json");
  app.add_option("--out", options->out, "the cell file; its other members stay where it is there already")
      ->required()
      ->type_name("cell.json");
  add_board_options(app, options->board);
  app.add_option("--plate-thickness-mm", options->plate_thickness_mm, "from the printed face to the belt")
      ->check(CLI::Range(0.0, 200.0));
  example(app,
          "  beltpick calibrate belt bare --calibration calibration.json --out cell.json\n"
          "  beltpick calibrate belt plate --calibration calibration.json --board 11x8 --square-mm 20 "
          "--plate-thickness-mm 5 --out cell.json");
  return [options](Session& session) { return run(*options, session); };
}

}  // namespace beltpick::cli
