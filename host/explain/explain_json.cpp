#include "explain/explain_json.hpp"

#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/json_writer.hpp"
#include "explain/checks.hpp"
#include "pipeline/contest.hpp"

namespace beltpick::explain {
namespace {

using contract_io::Json;
using contract_io::json_matrix;

constexpr std::array kKindNames{"plane", "cylinder", "sphere"};

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json evidence_json(const result::Evidence& e) {
  return {{"in_view", e.in_view},
          {"support", e.support},
          {"coverage", e.coverage},
          {"free_space_violated", e.violated},
          {"occluded", e.occluded},
          {"shadowed", e.shadowed},
          {"contradicted", e.contradicted},
          {"unexplained", e.unexplained},
          {"under_belt", e.sunk},
          {"outline_continued", e.continued},
          {"rms_mm", e.rms_mm},
          {"points", e.points}};
}

Json alignment_json(const pipeline::Candidate& candidate) {
  const auto& from = candidate.hypothesis.T_camera_part;
  const auto& to = candidate.alignment.T_camera_part;
  return {{"moved_mm", (from.translation_mm - to.translation_mm).norm()},
          {"turned_deg", deg_from_rad(rotation_between_rad(from.rotation, to.rotation))},
          {"iterations", candidate.alignment.iterations},
          {"inlier_share", candidate.alignment.inlier_share},
          {"rms_mm", candidate.alignment.rms_mm}};
}

Json reason_json(const Error& reason) {
  if (reason.code == ResultCode::kOk) return {{"code", "VERIFIED"}};
  return {{"code", result_code_name(reason.code)}, {"detail", reason.text()}};
}

Json primitive_json(const FoundPrimitive& found, const Explained& explained) {
  const Primitive& p = found.primitive;
  return {{"part", explained.templates[static_cast<std::size_t>(found.model_index)].name},
          {"kind", kKindNames[static_cast<std::size_t>(p.kind)]},
          {"point_mm", vector_json(p.point_mm)},
          {"direction", vector_json(p.direction)},
          {"radius_mm", p.radius_mm},
          {"extent_mm", p.extent_mm},
          {"inlier_share", p.inlier_share},
          {"rms_mm", p.rms_mm}};
}

Json q_map_json(const QMap& map, const Explained& explained) {
  Json panels = Json::array();
  for (const QPanel& panel : map.panels) {
    Json cells = Json::array();
    for (const QPanel::Cell& cell : panel.cells) cells.push_back({cell.x, cell.y, cell.mean_distance_mm});
    panels.push_back({{"title", panel.title}, {"x", panel.x_label}, {"y", panel.y_label}, {"cells", cells}});
  }
  return {{"part", explained.templates[static_cast<std::size_t>(map.model_index)].name},
          {"about", map.about},
          {"tried", map.tried},
          {"best_mean_distance_mm", map.best_mm},
          {"panels", panels}};
}

Json candidate_json(const pipeline::Candidate& candidate, const Explained& explained) {
  return {{"part", explained.templates[static_cast<std::size_t>(candidate.model_index)].name},
          {"mean_distance_mm", candidate.hypothesis.mean_distance_mm},
          {"impression", candidate.impression},
          {"strength", candidate.strength},
          {"pose_camera", json_matrix(candidate.alignment.T_camera_part.matrix())},
          {"alignment", alignment_json(candidate)}};
}

Json judged_json(const Judged& judged, const Explained& explained) {
  Json json = candidate_json(judged.champion, explained);
  json["evidence"] = evidence_json(judged.champion.evidence);
  const PartModel& model = explained.models[static_cast<std::size_t>(judged.champion.model_index)];
  const result::Scene& scene = *explained.recorder.scene();
  Json checks = Json::array();
  for (const Check& check :
       checks_of(judged.champion.evidence, result::surface_tolerance_mm(scene, model.spacing_mm), model.required)) {
    checks.push_back({{"name", check.name},
                      {"value", check.value},
                      {check.at_least ? "at_least" : "at_most", check.limit},
                      {"passed", check.passed()}});
  }
  json["checks"] = checks;
  Json rivals = Json::array();
  for (const RivalStory& story : judged.rivals) {
    Json rival = candidate_json(story.rival, explained);
    rival["pixels_on_both"] = story.rivalry.both;
    rival["pixels_on_champion_only"] = story.rivalry.only_first;
    rival["pixels_on_rival_only"] = story.rivalry.only_second;
    rival["same_object"] = story.rivalry.same_object();
    rival["champion_prevails"] = pipeline::stands(judged.champion, story.rival, story.rivalry);
    rivals.push_back(std::move(rival));
  }
  json["rivals"] = rivals;
  json["verdict"] = reason_json(judged.verdict);
  return json;
}

Json search_json(const SearchStory& search, const Explained& explained) {
  Json labels = Json::array(), primitives = Json::array(), maps = Json::array(), weighed = Json::array(),
       judged = Json::array();
  for (int i = 0; i < search.object.label_count; ++i) labels.push_back(search.object.labels[i]);
  for (const FoundPrimitive& found : search.primitives) primitives.push_back(primitive_json(found, explained));
  for (const QMap& map : q_maps(search, explained.models)) maps.push_back(q_map_json(map, explained));
  for (const pipeline::Candidate& candidate : search.weighed) weighed.push_back(candidate_json(candidate, explained));
  for (const Judged& one : search.judged) judged.push_back(judged_json(one, explained));
  return {{"route", route_name(search.route)},
          {"segments", labels},
          {"sample_points", search.sample.size()},
          {"primitives", primitives},
          {"q_maps", maps},
          {"hypotheses_aligned", search.coarse.size()},
          {"weighed", weighed},
          {"judged", judged},
          {"outcome", reason_json(search.attempt.reason)}};
}

Json chapter_json(const Chapter& chapter, const Explained& explained) {
  constexpr std::array kFates{"located", "withheld", "explained by another"};
  Json searches = Json::array();
  for (const SearchStory* search : chapter.searches) searches.push_back(search_json(*search, explained));
  Json json = {{"segment", chapter.segment.label},
               {"pixels", chapter.segment.pixels},
               {"fate", kFates[static_cast<std::size_t>(chapter.fate)]},
               {"words", fate_of(chapter, explained.located, explained.templates)},
               {"searches", searches}};
  if (const std::string advice = advice_of(chapter, explained.located); !advice.empty()) json["advice"] = advice;
  return json;
}

Json part_json(const LocatedPart& part, const pipeline::Candidate& candidate, const Explained& explained) {
  return {{"part", explained.templates[static_cast<std::size_t>(part.template_index)].name},
          {"segment", part.segment},
          {"search", {{"mean_distance_mm", candidate.hypothesis.mean_distance_mm}}},
          {"alignment", alignment_json(candidate)},
          {"evidence", evidence_json(candidate.evidence)}};
}

Json withheld_json(const WithheldObject& object) {
  return {{"segment", object.segment},
          {"stage", stage_name(object.stage)},
          {"code", result_code_name(object.reason.code)},
          {"detail", object.reason.text()}};
}

}  // namespace

std::string explanation_json(const Explained& explained, const std::vector<Chapter>& chapters) {
  Json parts = Json::array(), withheld = Json::array(), segments = Json::array();
  const pipeline::LocateOutput& found = explained.located.found;
  for (std::size_t i = 0; i < found.parts.size(); ++i) {
    parts.push_back(part_json(found.parts[i], found.candidates[i], explained));
  }
  for (const WithheldObject& object : found.withheld) withheld.push_back(withheld_json(object));
  for (const Chapter& chapter : chapters) segments.push_back(chapter_json(chapter, explained));
  return contract_io::json_text({{"format", "beltpick-explanation"},
                                 {"version", 1},
                                 {"parts", parts},
                                 {"withheld", withheld},
                                 {"segments", segments}});
}

}  // namespace beltpick::explain
