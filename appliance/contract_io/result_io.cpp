#include "contract_io/result_io.hpp"

#include "base/units.hpp"
#include "contract/freedoms.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/json_writer.hpp"

namespace beltpick::contract_io {
namespace {

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

// A pose under `suffix` "camera", and where the cell is known "belt" and "robot".
template <class From>
void append_poses(const std::string& prefix, const Pose<frame::Camera, From>& T_camera_from, const Cell& cell,
                  Json& json) {
  json[prefix + "_camera"] = json_matrix(T_camera_from.matrix());
  if (cell.T_belt_camera) json[prefix + "_belt"] = json_matrix((*cell.T_belt_camera * T_camera_from).matrix());
  if (cell.T_robot_camera) json[prefix + "_robot"] = json_matrix((*cell.T_robot_camera * T_camera_from).matrix());
}

Json grasp_json(const LocatedPart& part, const PartTemplate& taught, const Cell& cell) {
  if (part.grasp_index < 0 || part.grasp_index >= static_cast<int>(taught.grasps.size())) return {};
  const Grasp& grasp = taught.grasps[static_cast<std::size_t>(part.grasp_index)];
  Json json = {{"name", grasp.name}, {"opening_mm", grasp.opening_mm}};
  append_poses("pose", part.T_camera_part * grasp.T_part_gripper, cell, json);
  return json;
}

Json freedom_json(const Freedom& freedom) {
  Json json = {{"motion", freedom.words}, {"observable", freedom.observable}};
  json[freedom.turn ? "sigma_deg" : "sigma_mm"] = freedom.turn ? deg_from_rad(freedom.sigma) : freedom.sigma;
  json["rim_mm"] = freedom.rim_mm;
  return json;
}

// How firmly each motion of the part is held, and in words what cannot be told.
void append_freedoms(const LocatedPart& part, const PartTemplate& taught, Json& json) {
  const auto freedoms = freedoms_of(part.covariance, part.T_camera_part, taught);
  json["freedoms"] = Json::array();
  for (const Freedom& freedom : freedoms) json["freedoms"].push_back(freedom_json(freedom));
  json["unobservable"] = unobservable(freedoms, taught.symmetry);
}

Json part_json(const LocatedPart& part, const PartTemplate& taught, const Cell& cell) {
  Json json = {{"part", taught.name},
               {"segment", part.segment},
               {"status", part.status == PoseStatus::kVerified ? "verified" : "ambiguous"}};
  append_poses("pose", part.T_camera_part, cell, json);
  json["grasp"] = grasp_json(part, taught, cell);
  if (part.grasp_index < 0) {
    json["not_offered"] = {{"stage", stage_name(Stage::kRank)},
                           {"code", result_code_name(part.not_offered.code)},
                           {"detail", part.not_offered.text()}};
  }
  json["rms_mm"] = part.rms_mm;
  json["coverage"] = part.coverage;
  json["score"] = part.score;
  json["symmetry"] = taught.symmetry.name;
  json["covariance"] = json_matrix(part.covariance);
  append_freedoms(part, taught, json);
  json["touches_neighbour"] = part.touches_neighbour;
  return json;
}

Json withheld_json(const WithheldObject& object) {
  return {{"segment", object.segment},
          {"stage", stage_name(object.stage)},
          {"code", result_code_name(object.reason.code)},
          {"detail", object.reason.text()}};
}

Json timing_json(const LocateReport& report) {
  Json json = Json::object();
  for (const auto& time : report.stage_times) json[stage_name(time.stage)] = time.ms;
  Json parts = Json::array();
  for (const auto& time : report.part_times) parts.push_back({{"segment", time.segment}, {"total", time.total_ms}});
  json["parts"] = std::move(parts);
  return json;
}

}  // namespace

std::string result_text(const LocateReport& report, std::span<const PartTemplate> templates, const Cell& cell) {
  Json parts = Json::array();
  for (const LocatedPart& part : report.parts) {
    parts.push_back(part_json(part, templates[static_cast<std::size_t>(part.template_index)], cell));
  }
  Json withheld = Json::array();
  for (const WithheldObject& object : report.withheld) withheld.push_back(withheld_json(object));
  Json memory = Json::object();
  for (const auto& share : report.memory) memory[share.name] = share.bytes;
  return json_text({{"format", "beltpick-result"},
                    {"version", 1},
                    {"capture_id", text_or_null(report.capture_id)},
                    {"calibration_id", text_or_null(report.calibration_id)},
                    {"parts", std::move(parts)},
                    {"withheld", std::move(withheld)},
                    {"timing_ms", timing_json(report)},
                    {"memory", std::move(memory)}});
}

Result<void> write_result(const std::filesystem::path& path, const LocateReport& report,
                          std::span<const PartTemplate> templates, const Cell& cell) {
  return write_file(path, result_text(report, templates, cell));
}

}  // namespace beltpick::contract_io
