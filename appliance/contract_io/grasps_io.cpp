#include "contract_io/grasps_io.hpp"

#include <algorithm>
#include <array>

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::contract_io {

namespace {

Result<Vec3> read_vector(const toml::table& grasp, const char* member, const char* where) {
  const toml::array* values = grasp[member].as_array();
  if (values == nullptr) {
    return failure(ResultCode::kMemberMissing, "%s: %s: expected three numbers, found none", where, member);
  }
  Vec3 v = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto number = values->size() == 3 ? (*values)[k].value<double>() : std::nullopt;
    if (!number) return failure(ResultCode::kFormatInvalid, "%s: %s: expected three numbers", where, member);
    v[static_cast<Eigen::Index>(k)] = *number;
  }
  return v;
}

Result<Grasp> read_grasp(const toml::table& table, const char* where) {
  const auto position_mm = read_vector(table, "position_mm", where);
  const auto approach = position_mm ? read_vector(table, "approach", where) : position_mm;
  const auto closing = approach ? read_vector(table, "closing", where) : approach;
  if (!closing) return std::unexpected(closing.error());
  if (approach->cross(*closing).norm() < 0.1 * approach->norm() * closing->norm() || approach->norm() < 1e-6 ||
      closing->norm() < 1e-6) {
    return failure(ResultCode::kValueOutOfRange,
                   "%s: closing: expected a direction across 'approach', found one along it", where);
  }
  const auto opening_mm = table["opening_mm"].value<double>();
  if (!opening_mm || *opening_mm <= 0) {
    return failure(ResultCode::kMemberMissing, "%s: opening_mm: expected a positive number of mm", where);
  }
  return Grasp{table["name"].value_or(std::string("grasp")), gripper_pose(*position_mm, *approach, *closing),
               *opening_mm};
}

Result<toml::table> read_table(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  try {
    return toml::parse(*bytes);
  } catch (const toml::parse_error& error) {
    return failure(ResultCode::kFormatInvalid, "%s: line %u: %s", path.c_str(), error.source().begin.line,
                   std::string(error.description()).c_str());
  }
}

}  // namespace

Pose<frame::Part, frame::Gripper> gripper_pose(const Vec3& position_mm, const Vec3& approach, const Vec3& closing) {
  const Vec3 z = approach.normalized();
  const Vec3 x = (closing - closing.dot(z) * z).normalized();
  Pose<frame::Part, frame::Gripper> pose;
  pose.rotation << x, z.cross(x), z;
  pose.translation_mm = position_mm;
  return pose;
}

Result<std::vector<Grasp>> read_grasps(const std::filesystem::path& path) {
  const auto root = read_table(path);
  if (!root) return std::unexpected(root.error());
  std::vector<Grasp> grasps;
  const toml::array* list = (*root)["grasp"].as_array();
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const toml::table* table = (*list)[i].as_table();
    const std::string where = path.string() + ": grasp " + std::to_string(i + 1);
    if (table == nullptr) return failure(ResultCode::kFormatInvalid, "%s: expected a table [[grasp]]", where.c_str());
    auto grasp = read_grasp(*table, where.c_str());
    if (!grasp) return std::unexpected(grasp.error());
    grasps.push_back(*grasp);
  }
  if (grasps.empty()) {
    return failure(ResultCode::kMemberMissing, "%s: expected at least one table [[grasp]], found none", path.c_str());
  }
  return grasps;
}

std::span<const GripperMember> gripper_members() {
  static constexpr std::array kMembers{GripperMember{"jaw_thickness_mm", &GripperShape::jaw_thickness_mm},
                                       GripperMember{"jaw_width_mm", &GripperShape::jaw_width_mm},
                                       GripperMember{"jaw_depth_mm", &GripperShape::jaw_depth_mm},
                                       GripperMember{"tip_mm", &GripperShape::tip_mm},
                                       GripperMember{"palm_length_mm", &GripperShape::palm_length_mm},
                                       GripperMember{"palm_width_mm", &GripperShape::palm_width_mm},
                                       GripperMember{"reach_mm", &GripperShape::reach_mm}};
  return kMembers;
}

const char* gripper_fault(const GripperShape& gripper) {
  constexpr double kLargest_mm = 10'000;
  for (const GripperMember& member : gripper_members()) {
    const double value = gripper.*member.value;
    if (!(value >= 0.0 && value <= kLargest_mm)) return "expected 0 to 10000 mm";
  }
  if (gripper.jaw_thickness_mm <= 0.0 || gripper.jaw_width_mm <= 0.0) {
    return "jaw_thickness_mm, jaw_width_mm: expected more than 0 mm";
  }
  if (gripper.jaw_depth_mm <= gripper.tip_mm) return "jaw_depth_mm: expected more than tip_mm";
  return nullptr;
}

Result<std::optional<GripperShape>> read_gripper(const std::filesystem::path& path) {
  const auto root = read_table(path);
  if (!root) return std::unexpected(root.error());
  const toml::table* table = (*root)["gripper"].as_table();
  if (table == nullptr) return std::nullopt;
  GripperShape gripper;
  const auto members = gripper_members();
  for (const auto& [key, node] : *table) {
    const auto member =
        std::find_if(members.begin(), members.end(), [&](const GripperMember& m) { return key.str() == m.name; });
    if (member == members.end()) {
      return failure(ResultCode::kUsage, "%s: gripper: unknown key '%s'; check its spelling", path.c_str(),
                     std::string(key.str()).c_str());
    }
    const auto value = node.value<double>();
    if (!value) {
      return failure(ResultCode::kFormatInvalid, "%s: gripper.%s: expected a number of mm", path.c_str(), member->name);
    }
    gripper.*(member->value) = *value;
  }
  if (const char* fault = gripper_fault(gripper)) {
    return failure(ResultCode::kValueOutOfRange, "%s: gripper: %s", path.c_str(), fault);
  }
  return gripper;
}

}  // namespace beltpick::contract_io
