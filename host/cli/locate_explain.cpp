#include "locate_explain.hpp"

#include <filesystem>

#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/json_writer.hpp"
#include "contract_io/pictures.hpp"

namespace beltpick::cli {
namespace {

using contract_io::Json;

Json evidence_json(const result::Evidence& e) {
  return {{"in_view", e.in_view},
          {"support", e.support},
          {"coverage", e.coverage},
          {"free_space_violated", e.violated},
          {"occluded", e.occluded},
          {"contradicted", e.contradicted},
          {"unexplained", e.unexplained},
          {"under_belt", e.sunk},
          {"outline_continued", e.continued},
          {"rms_mm", e.rms_mm},
          {"points", e.points}};
}

Json part_json(const LocatedPart& part, const pipeline::Candidate& candidate, const PartTemplate& taught) {
  const double turned = rotation_between_rad(candidate.hypothesis.T_camera_part.rotation, part.T_camera_part.rotation);
  const double moved = (candidate.hypothesis.T_camera_part.translation_mm - part.T_camera_part.translation_mm).norm();
  return {{"part", taught.name},
          {"segment", part.segment},
          {"search", {{"mean_distance_mm", candidate.hypothesis.mean_distance_mm}}},
          {"alignment",
           {{"moved_mm", moved},
            {"turned_deg", deg_from_rad(turned)},
            {"iterations", candidate.alignment.iterations},
            {"inlier_share", candidate.alignment.inlier_share},
            {"rms_mm", candidate.alignment.rms_mm}}},
          {"evidence", evidence_json(candidate.evidence)}};
}

Json withheld_json(const WithheldObject& object) {
  return {{"segment", object.segment},
          {"stage", stage_name(object.stage)},
          {"code", result_code_name(object.reason.code)},
          {"detail", object.reason.text()}};
}

}  // namespace

Result<void> explain(const std::string& folder, const pipeline::Located& located, const RangeInput& input,
                     const std::vector<PartTemplate>& templates) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return failure(ResultCode::kFileNotWritten, "%s: %s", folder.c_str(), failed.message().c_str());
  Json parts = Json::array();
  for (std::size_t i = 0; i < located.found.parts.size(); ++i) {
    const LocatedPart& part = located.found.parts[i];
    parts.push_back(
        part_json(part, located.found.candidates[i], templates[static_cast<std::size_t>(part.template_index)]));
  }
  Json withheld = Json::array();
  for (const WithheldObject& object : located.found.withheld) withheld.push_back(withheld_json(object));
  const Json all = {{"parts", parts}, {"withheld", withheld}};
  const std::filesystem::path to(folder);
  if (auto written = contract_io::write_file(to / "explain.json", contract_io::json_text(all)); !written)
    return written;
  const auto labels = contract_io::labels_picture(located.objects.labels, input.picture());
  return contract_io::write_png(to / "labels.png", labels.view());
}

}  // namespace beltpick::cli
