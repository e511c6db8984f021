#include "calibrate/outcome_json.hpp"

#include "contract_io/json_writer.hpp"

namespace beltpick::calibrate {
namespace {

using contract_io::Json;

Json to_json(const PixelPosition& pixel) { return {pixel.column_px, pixel.row_px}; }

Json to_json(const CornerOutcome& corner) {
  Json json = {{"corner", corner.corner},
               {"camera_px", to_json(corner.camera_px)},
               {"projector_px", to_json(corner.projector_px)},
               {"camera_residual_px", to_json(corner.camera_residual_px)},
               {"projector_residual_px", to_json(corner.projector_residual_px)},
               {"used", corner.used}};
  if (!corner.reason.empty()) json["reason"] = corner.reason;
  return json;
}

Json to_json(const PoseOutcome& pose) {
  Json json = {{"capture", pose.capture}, {"used", pose.used}};
  if (!pose.reason.empty()) json["reason"] = pose.reason;
  json["camera_from_plate"] = contract_io::json_matrix(pose.T_camera_plate.matrix());
  json["distance_mm"] = pose.distance_mm;
  json["tilt_deg"] = {pose.tilt_x_deg, pose.tilt_y_deg};
  json["camera_rms_px"] = pose.camera_rms_px;
  json["projector_rms_px"] = pose.projector_rms_px;
  json["stereo_rms_px"] = pose.stereo_rms_px;
  if (pose.held_out) {
    json["held_out"] = {
        {"rms_mm", pose.held_out_rms_mm}, {"max_mm", pose.held_out_max_mm}, {"size_ppm", pose.held_out_size_ppm}};
  }
  json["corners"] = Json::array();
  for (const CornerOutcome& corner : pose.corners) json["corners"].push_back(to_json(corner));
  return json;
}

Json to_json(const CoverageGrid& grid) {
  return {{"columns", grid.columns}, {"rows", grid.rows}, {"share", grid.share()}, {"counts", grid.counts}};
}

Json to_json(const Coverage& coverage) {
  return {{"camera", to_json(coverage.camera)},
          {"projector", to_json(coverage.projector)},
          {"near_mm", coverage.near_mm},
          {"far_mm", coverage.far_mm},
          {"depth_counts", coverage.depth_counts},
          {"tilt_range_deg", {coverage.tilt_x_range_deg, coverage.tilt_y_range_deg}}};
}

Json to_json(const LeftOut& one) {
  Json json = {{"capture", one.capture}, {"reason", one.reason}};
  if (one.corner >= 0) {
    json["corner"] = one.corner;
    json["residual_px"] = one.residual_px;
  }
  return json;
}

Json to_json(const ParameterOutcome& parameter) {
  return {{"name", parameter.name}, {"unit", parameter.unit}, {"value", parameter.value}, {"sigma", parameter.sigma}};
}

// What both the report and calibration.json tell in the same words.
Json summary(const Outcome& outcome) {
  return {{"grade", kGradeNames[static_cast<std::size_t>(outcome.grade)]},
          {"verdict", outcome.verdict},
          {"poses_used", outcome.poses_used},
          {"corners_used", outcome.corners_used},
          {"corners_left_out", outcome.corners_left_out},
          {"camera_rms_px", outcome.camera_rms_px},
          {"projector_rms_px", outcome.projector_rms_px},
          {"stereo_rms_px", outcome.stereo_rms_px}};
}

template <class Items>
Json list_of(const Items& items) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(to_json(item));
  return list;
}

}  // namespace

std::string outcome_json(const Outcome& outcome) {
  const Board& board = outcome.board;
  Json json = {{"format", "beltpick-calibration-report"},
               {"version", 1},
               {"calibration_id", outcome.calibration.id},
               {"board", {{"columns", board.columns}, {"rows", board.rows}, {"square_mm", board.square_mm}}},
               {"held_out",
                {{"rms_mm", outcome.held_out_rms_mm},
                 {"max_mm", outcome.held_out_max_mm},
                 {"size_ppm", outcome.held_out_size_ppm}}},
               {"point_sigma_mm", {{"rms", outcome.point_sigma_mm}, {"worst", outcome.point_sigma_max_mm}}},
               {"plate",
                {{"peak_to_valley_mm", outcome.plate.peak_to_valley_mm},
                 {"symmetric", outcome.plate.symmetric},
                 {"height_mm", outcome.plate.height_mm},
                 {"sigma_mm", outcome.plate.sigma_mm}}}};
  json.update(summary(outcome));
  if (board.is_charuco()) {
    json["board"]["marker_mm"] = board.marker_mm;
    json["board"]["dictionary"] = board.dictionary;
  }
  json["coverage"] = to_json(outcome.coverage);
  json["parameters"] = list_of(outcome.parameters);
  json["left_out"] = list_of(outcome.left_out);
  json["poses"] = list_of(outcome.poses);
  return contract_io::json_text(json);
}

std::string quality_json(const Outcome& outcome) {
  Json sigmas = Json::object();
  for (const ParameterOutcome& parameter : outcome.parameters) sigmas[parameter.name] = parameter.sigma;
  const Coverage& coverage = outcome.coverage;
  Json json = summary(outcome);
  json.update({{"held_out_rms_mm", outcome.held_out_rms_mm},
               {"held_out_max_mm", outcome.held_out_max_mm},
               {"held_out_size_ppm", outcome.held_out_size_ppm},
               {"point_sigma_mm", outcome.point_sigma_mm},
               {"plate_peak_to_valley_mm", outcome.plate.peak_to_valley_mm},
               {"coverage",
                {{"camera", coverage.camera.share()},
                 {"projector", coverage.projector.share()},
                 {"near_mm", coverage.near_mm},
                 {"far_mm", coverage.far_mm},
                 {"tilt_range_deg", {coverage.tilt_x_range_deg, coverage.tilt_y_range_deg}}}},
               {"sigma", sigmas}});
  return contract_io::json_text(json);
}

}  // namespace beltpick::calibrate
