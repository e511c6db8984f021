#include "bench/pose/fate_json.hpp"

#include <nlohmann/json.hpp>

namespace beltpick::bench {
namespace {

using Json = nlohmann::json;

Json json_of(const TruePartFate& p) {
  return {{"part", p.part},         {"loaded", p.loaded},         {"visible", p.visible},
          {"measured", p.measured}, {"found", p.found},           {"mm", p.error.mm},
          {"deg", p.error.deg},     {"surface_mm", p.surface_mm}, {"why", p.why}};
}

TruePartFate part_of(const Json& j) {
  return {j.at("part"),       j.at("loaded"), j.at("visible"),
          j.at("measured"),   j.at("found"),  {j.at("mm"), j.at("deg")},
          j.at("surface_mm"), j.at("why")};
}

Json json_of(const FalsePose& p) {
  return {{"part", p.part},   {"nearest", p.nearest},   {"mm", p.error.mm},        {"deg", p.error.deg},
          {"score", p.score}, {"coverage", p.coverage}, {"duplicate", p.duplicate}};
}

FalsePose false_pose_of(const Json& j) {
  return {j.at("part"), j.at("nearest"), {j.at("mm"), j.at("deg")}, j.at("score"), j.at("coverage"), j.at("duplicate")};
}

}  // namespace

std::string to_line(const SceneRecord& record) {
  const SceneFate& fate = record.fate;
  Json j{{"scene", record.scene},
         {"kind", record.kind},
         {"parts", Json::array()},
         {"false", Json::array()},
         {"object_ms", fate.found_object_ms},
         {"ms", {fate.render_ms, fate.fold_ms, fate.decode_ms, fate.range_ms, fate.segment_ms, fate.locate_ms}}};
  for (const TruePartFate& part : fate.parts) j["parts"].push_back(json_of(part));
  for (const FalsePose& pose : fate.false_poses) j["false"].push_back(json_of(pose));
  return j.dump();
}

SceneRecord from_line(const std::string& line) {
  const Json j = Json::parse(line);
  SceneRecord record{j.at("scene"), j.at("kind"), {}};
  SceneFate& fate = record.fate;
  for (const Json& part : j.at("parts")) fate.parts.push_back(part_of(part));
  for (const Json& pose : j.at("false")) fate.false_poses.push_back(false_pose_of(pose));
  fate.found_object_ms = j.at("object_ms").get<std::vector<double>>();
  const Json& ms = j.at("ms");
  fate.render_ms = ms.at(0), fate.fold_ms = ms.at(1), fate.decode_ms = ms.at(2);
  fate.range_ms = ms.at(3), fate.segment_ms = ms.at(4), fate.locate_ms = ms.at(5);
  return record;
}

}  // namespace beltpick::bench
