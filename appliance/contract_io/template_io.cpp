#include "contract_io/template_io.hpp"

#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/grasps_io.hpp"
#include "contract_io/template_judge.hpp"

namespace beltpick::contract_io {

namespace {

using Json = nlohmann::json;

constexpr int kVersion = 1;
constexpr std::size_t kMaxPoints = 10'000'000;
constexpr std::array kKindNames{"plane", "cylinder", "sphere"};

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json to_json(const Mat4& m) {
  Json rows = Json::array();
  for (int r = 0; r < 4; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
  return rows;
}

Json to_json(const Primitive& p) {
  return {{"kind", kKindNames[static_cast<std::size_t>(p.kind)]},
          {"point_mm", to_json(p.point_mm)},
          {"direction", to_json(p.direction)},
          {"radius_mm", p.radius_mm},
          {"extent_mm", p.extent_mm},
          {"concave", p.concave},
          {"surface_share", p.inlier_share},
          {"rms_mm", p.rms_mm}};
}

Json to_json(const Symmetry& s) {
  Json elements = Json::array();
  for (const auto& element : s.elements) elements.push_back(to_json(element.matrix()));
  return {{"name", s.name},
          {"elements", elements},
          {"revolution", s.revolution},
          {"axis_point_mm", to_json(s.axis_point_mm)},
          {"axis_direction", to_json(s.axis_direction)}};
}

Json to_json(const GripperShape& gripper) {
  Json json = Json::object();
  for (const GripperMember& member : gripper_members()) json[member.name] = gripper.*member.value;
  return json;
}

GripperShape gripper_from(const Json& json) {
  GripperShape gripper;
  for (const GripperMember& member : gripper_members()) {
    gripper.*member.value = json.value(member.name, gripper.*member.value);
  }
  return gripper;
}

Json to_json(const TaughtCone& c) {
  return {{"apex_mm", to_json(c.apex_mm)},
          {"direction", to_json(c.direction)},
          {"half_angle_rad", c.half_angle_rad},
          {"from_mm", c.from_mm},
          {"to_mm", c.to_mm},
          {"concave", c.concave},
          {"surface_share", c.surface_share}};
}

Json to_json(const RestingPosition& r) {
  return {{"down", to_json(r.down)}, {"height_mm", r.height_mm}, {"likelihood", r.likelihood}};
}

Json to_json(const RecognitionRoute& r) {
  return {{"primitive", r.primitive}, {"visible", r.visible}, {"poses", r.poses}};
}

Json to_json(const Requirements& requirements) {
  Json json = Json::object();
  for (const RequirementMember& member : kRequirementMembers) json[member.name] = requirements.*member.value;
  return json;
}

Requirements requirements_from(const Json& json) {
  Requirements requirements;
  for (const RequirementMember& member : kRequirementMembers) {
    requirements.*member.value = json.value(member.name, requirements.*member.value);
  }
  return requirements;
}

template <class T>
Json list_of(const std::vector<T>& items) {
  Json list = Json::array();
  for (const T& item : items) list.push_back(to_json(item));
  return list;
}

Json header_of(const PartTemplate& part) {
  Json grasps = Json::array();
  for (const Grasp& grasp : part.grasps) {
    grasps.push_back({{"name", grasp.name},
                      {"part_from_gripper", to_json(grasp.T_part_gripper.matrix())},
                      {"opening_mm", grasp.opening_mm}});
  }
  Json header = {{"format", "beltpick-template"},
                 {"version", kVersion},
                 {"points", part.point_mm.size()},
                 {"spacing_mm", part.spacing_mm},
                 {"box_min_mm", to_json(part.box_min_mm)},
                 {"box_max_mm", to_json(part.box_max_mm)},
                 {"primitives", list_of(part.primitives)},
                 {"symmetry", to_json(part.symmetry)},
                 {"grasps", grasps},
                 {"cones", list_of(part.cones)},
                 {"resting_positions", list_of(part.resting)},
                 {"routes", list_of(part.routes)},
                 {"search_steps", {{"turn_rad", part.steps.turn_rad}, {"shift_mm", part.steps.shift_mm}}}};
  if (part.gripper) header["gripper"] = to_json(*part.gripper);
  if (part.requirements) header["requirements"] = to_json(*part.requirements);
  return header;
}

Vec3 vec3_from(const Json& json) {
  if (!json.is_array() || json.size() != 3) throw Json::other_error::create(501, "expected three numbers", &json);
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

Mat4 mat4_from(const Json& json) {
  if (!json.is_array() || json.size() != 4) throw Json::other_error::create(501, "expected a 4x4 matrix", &json);
  Mat4 m;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c)
      m(r, c) = json.at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c)).get<double>();
  }
  return m;
}

Primitive primitive_from(const Json& json) {
  Primitive p;
  const auto kind = json.at("kind").get<std::string>();
  const auto* const found = std::find(kKindNames.begin(), kKindNames.end(), kind);
  if (found == kKindNames.end()) throw Json::other_error::create(501, "unknown primitive kind '" + kind + "'", &json);
  p.kind = static_cast<PrimitiveKind>(found - kKindNames.begin());
  p.point_mm = vec3_from(json.at("point_mm"));
  p.direction = vec3_from(json.at("direction"));
  p.radius_mm = json.at("radius_mm").get<double>();
  p.extent_mm = json.at("extent_mm").get<double>();
  p.concave = json.at("concave").get<bool>();
  p.inlier_share = json.at("surface_share").get<double>();
  p.rms_mm = json.at("rms_mm").get<double>();
  return p;
}

Symmetry symmetry_from(const Json& json) {
  Symmetry s;
  s.name = json.at("name").get<std::string>();
  for (const Json& element : json.at("elements")) {
    s.elements.push_back(Pose<frame::Part, frame::Part>::from_matrix(mat4_from(element)));
  }
  s.revolution = json.at("revolution").get<bool>();
  s.axis_point_mm = vec3_from(json.at("axis_point_mm"));
  s.axis_direction = vec3_from(json.at("axis_direction"));
  return s;
}

void read(const Json& json, TaughtCone& c) {
  c.apex_mm = vec3_from(json.at("apex_mm"));
  c.direction = vec3_from(json.at("direction"));
  c.half_angle_rad = json.at("half_angle_rad").get<double>();
  c.from_mm = json.at("from_mm").get<double>();
  c.to_mm = json.at("to_mm").get<double>();
  c.concave = json.at("concave").get<bool>();
  c.surface_share = json.at("surface_share").get<double>();
}

void read(const Json& json, RestingPosition& r) {
  r.down = vec3_from(json.at("down"));
  r.height_mm = json.at("height_mm").get<double>();
  r.likelihood = json.at("likelihood").get<double>();
}

void read(const Json& json, RecognitionRoute& r) {
  r.primitive = json.at("primitive").get<int>();
  r.visible = json.at("visible").get<double>();
  r.poses = json.at("poses").get<int>();
}

// A list that templates of earlier versions lack.
template <class T>
void read_list(const Json& json, const char* member, std::vector<T>& items) {
  const auto list = json.find(member);
  if (list == json.end()) return;
  for (const Json& item : *list) read(item, items.emplace_back());
}

PartTemplate part_from(const Json& json) {
  PartTemplate part;
  part.spacing_mm = json.at("spacing_mm").get<double>();
  part.box_min_mm = vec3_from(json.at("box_min_mm"));
  part.box_max_mm = vec3_from(json.at("box_max_mm"));
  for (const Json& primitive : json.at("primitives")) part.primitives.push_back(primitive_from(primitive));
  part.symmetry = symmetry_from(json.at("symmetry"));
  for (const Json& grasp : json.at("grasps")) {
    part.grasps.push_back({grasp.at("name").get<std::string>(),
                           Pose<frame::Part, frame::Gripper>::from_matrix(mat4_from(grasp.at("part_from_gripper"))),
                           grasp.at("opening_mm").get<double>()});
  }
  if (json.contains("gripper")) part.gripper = gripper_from(json.at("gripper"));
  if (json.contains("requirements")) part.requirements = requirements_from(json.at("requirements"));
  read_list(json, "cones", part.cones);
  read_list(json, "resting_positions", part.resting);
  read_list(json, "routes", part.routes);
  if (const auto steps = json.find("search_steps"); steps != json.end()) {
    part.steps = {steps->at("turn_rad").get<double>(), steps->at("shift_mm").get<double>()};
  }
  return part;
}

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

struct Parts {
  std::string_view json;
  std::string_view payload;
};

// Checks the first line and the checksum, and finds the parts behind it.
Result<Parts> take_apart(std::string_view bytes, const char* name) {
  const std::size_t line_end = bytes.substr(0, 200).find('\n');
  int version = 0;
  unsigned sum = 0;
  unsigned long json_bytes = 0;
  const std::string line(bytes.substr(0, line_end == std::string_view::npos ? 0 : line_end));
  if (std::sscanf(line.c_str(), "beltpick-template %d %8x %lu", &version, &sum, &json_bytes) != 3) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: expected a template written by 'beltpick teach', found something else", name);
  }
  if (version != kVersion) {
    return failure(ResultCode::kVersionUnsupported, "%s: version: expected %d, found %d; %s", name, kVersion, version,
                   version > kVersion ? "a later beltpick wrote it: update this one, or teach the part again with it"
                                      : "teach the part again");
  }
  const std::string_view rest = bytes.substr(line_end + 1);
  if (checksum(rest) != sum || json_bytes > rest.size()) {
    return failure(ResultCode::kChecksumWrong,
                   "%s: checksum: expected %08x, found %08x; the file is damaged, copy or teach it again", name, sum,
                   checksum(rest));
  }
  return Parts{rest.substr(0, json_bytes), rest.substr(json_bytes)};
}

Result<void> read_points(std::string_view payload, std::size_t count, const char* name, PartTemplate& part) {
  if (count == 0 || count > kMaxPoints || payload.size() != count * 24) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: points: expected %zu bytes for %zu points, found %zu; teach the part again", name, count * 24,
                   count, payload.size());
  }
  part.point_mm.resize(count);
  part.normal.resize(count);
  std::memcpy(static_cast<void*>(part.point_mm.data()), payload.data(), count * 12);
  std::memcpy(static_cast<void*>(part.normal.data()), payload.data() + count * 12, count * 12);
  for (std::size_t i = 0; i < count; ++i) {
    if (!part.point_mm[i].allFinite() || !part.normal[i].allFinite()) {
      return failure(ResultCode::kValueOutOfRange, "%s: point %zu is not finite; teach the part again", name, i);
    }
  }
  return {};
}

}  // namespace

Result<PartTemplate> parse_template(std::string_view bytes, const std::string& name, const std::string& source) {
  const auto parts = take_apart(bytes, source.c_str());
  if (!parts) return std::unexpected(parts.error());
  try {
    const Json json = Json::parse(parts->json);
    PartTemplate part = part_from(json);
    part.name = name;
    if (auto read = read_points(parts->payload, json.at("points").get<std::size_t>(), source.c_str(), part); !read) {
      return std::unexpected(read.error());
    }
    if (auto judged = judge_template(part, source); !judged) return std::unexpected(judged.error());
    return part;
  } catch (const Json::exception& error) {
    return failure(ResultCode::kFormatInvalid, "%s: %s; teach the part again", source.c_str(),
                   one_line(error.what()).c_str());
  }
}

Result<PartTemplate> read_template(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  return parse_template(*bytes, path.stem().string(), one_line(path.string()));
}

Result<void> write_template(const std::filesystem::path& path, const PartTemplate& part) {
  const std::string json = header_of(part).dump();
  std::string rest = json;
  rest.append(reinterpret_cast<const char*>(part.point_mm.data()), part.point_mm.size() * 12);
  rest.append(reinterpret_cast<const char*>(part.normal.data()), part.normal.size() * 12);
  char line[80];
  std::snprintf(line, sizeof line, "beltpick-template %d %08x %zu\n", kVersion, checksum(rest), json.size());
  return write_file(path, line + rest);
}

}  // namespace beltpick::contract_io
