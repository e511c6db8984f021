// The built-in parts with their symmetries and grasps, and parts from files.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/grasps_io.hpp"
#include "contract_io/mesh_io.hpp"
#include "virtual_cell/render/part_shapes.hpp"
#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kCellMm = 1.4;
constexpr double kSheetCellMm = 1.0;  // of a sheet of 2.5 mm

Grasp grasp(std::string name, const Vec3& at_mm, const Vec3& approach, const Vec3& closing, double opening_mm) {
  return {std::move(name), contract_io::gripper_pose(at_mm, approach, closing), opening_mm};
}

// From every side that a resting part may turn upwards: the boss across its diameter, the arm across the rib, the eye.
std::vector<Grasp> knuckle_grasps() {
  std::vector<Grasp> grasps;
  for (const double sign : {1.0, -1.0}) {
    const Vec3 down(0.0, 0.0, -sign);
    const std::string side = sign > 0 ? "top" : "bottom";
    grasps.push_back(grasp("arm-" + side, {48.0, 6.5, -5.0 + 4.0 * sign}, down, Vec3::UnitY(), 58.0));
    grasps.push_back(grasp("boss-ends-" + side, {-44.0, 0.0, 6.0 * sign}, down, Vec3::UnitY(), 88.0));
    grasps.push_back(grasp("eye-" + side, {88.0, 12.0, -6.0 + 4.0 * sign}, down, Vec3::UnitY(), 52.0));
    const Vec3 along(0.0, -sign, 0.0);
    const std::string end = sign > 0 ? "left" : "right";
    grasps.push_back(grasp("boss-" + end, {-40.0, 22.0 * sign, 0.0}, along, Vec3::UnitZ(), 62.0));
    grasps.push_back(grasp("eye-" + end, {88.0, 12.0 + 8.0 * sign, -6.0}, along, Vec3::UnitZ(), 40.0));
  }
  grasps.push_back(grasp("boss-back", {-52.0, -4.0, 0.0}, Vec3::UnitX(), Vec3::UnitY(), 88.0));
  grasps.push_back(grasp("eye-front", {98.0, 12.0, -6.0}, -Vec3::UnitX(), Vec3::UnitZ(), 38.0));
  return grasps;
}

std::vector<Grasp> elbow_grasps() {
  std::vector<Grasp> grasps;
  const Vec3 bend(32.0, 32.0, 0.0);
  const Vec3 outward = Vec3(1.0, 1.0, 0.0).normalized();
  for (const double sign : {1.0, -1.0})
    grasps.push_back(grasp(sign > 0 ? "bend-top" : "bend-bottom", bend, {0.0, 0.0, -sign}, outward, 54.0));
  grasps.push_back(grasp("bend-outside", bend, -outward, Vec3::UnitZ(), 54.0));
  return grasps;
}

std::vector<Grasp> bracket_grasps() {
  return {grasp("post", {22.0, -8.0, 34.0}, -Vec3::UnitZ(), Vec3::UnitX(), 38.0),
          grasp("wall", {-50.0, 8.0, 52.0}, -Vec3::UnitZ(), Vec3::UnitX(), 22.0),
          grasp("base-end", {46.0, 0.0, 5.0}, -Vec3::UnitX(), Vec3::UnitZ(), 22.0)};
}

std::vector<Grasp> vblock_grasps() {
  return {grasp("sides", {4.0, 0.0, 20.0}, -Vec3::UnitZ(), Vec3::UnitY(), 76.0),
          grasp("web", {4.0, 0.0, 36.0}, -Vec3::UnitZ(), Vec3::UnitX(), 24.0)};
}

// Round the shank from all four sides, and the stud.
std::vector<Grasp> balljoint_grasps() {
  std::vector<Grasp> grasps;
  for (const double sign : {1.0, -1.0}) {
    const std::string side = sign > 0 ? "1" : "2";
    grasps.push_back(grasp("shank-above-" + side, {64.0, 0.0, 0.0}, {0.0, 0.0, -sign}, Vec3::UnitY(), 34.0));
    grasps.push_back(grasp("shank-beside-" + side, {64.0, 0.0, 0.0}, {0.0, -sign, 0.0}, Vec3::UnitZ(), 34.0));
    grasps.push_back(grasp("stud-" + side, {0.0, 0.0, 48.0}, {0.0, -sign, 0.0}, Vec3::UnitX(), 28.0));
  }
  return grasps;
}

std::vector<Grasp> sheet_grasps() {
  return {grasp("flange", {-53.75, 0.0, 18.0}, -Vec3::UnitZ(), Vec3::UnitX(), 16.0),
          grasp("tab", {15.0, 33.75, 11.0}, -Vec3::UnitZ(), Vec3::UnitY(), 16.0),
          grasp("end", {50.0, 8.0, 1.25}, -Vec3::UnitX(), Vec3::UnitZ(), 16.0),
          grasp("side", {8.0, -30.0, 1.25}, Vec3::UnitY(), Vec3::UnitZ(), 16.0)};
}

// Half a turn about the bisector of the two flanges.
Pose<frame::Part, frame::Part> elbow_half_turn() {
  const Vec3 bisector = Vec3(1.0, 1.0, 0.0).normalized();
  return {Eigen::AngleAxisd(kPi, bisector).toRotationMatrix(), Vec3::Zero()};
}

struct Builtin {
  const char* name;
  double (*distance)(const Vec3&);
  Eigen::AlignedBox3d (*box)();
  std::vector<Grasp> (*grasps)();
  double cell_mm = kCellMm;
};
constexpr std::array kBuiltins{Builtin{"knuckle", knuckle_distance, knuckle_box, knuckle_grasps},
                               Builtin{"elbow", elbow_distance, elbow_box, elbow_grasps},
                               Builtin{"bracket", bracket_distance, bracket_box, bracket_grasps},
                               Builtin{"vblock", vblock_distance, vblock_box, vblock_grasps},
                               Builtin{"balljoint", balljoint_distance, balljoint_box, balljoint_grasps},
                               Builtin{"sheet", sheet_distance, sheet_box, sheet_grasps, kSheetCellMm}};

void write_vector(std::ostream& out, const char* member, const Vec3& v) {
  out << member << " = [" << v.x() << ", " << v.y() << ", " << v.z() << "]\n";
}

Result<void> write_grasps(const ScenePart& part, const std::filesystem::path& file) {
  const std::filesystem::path temporary = file.string() + ".part";
  {
    std::ofstream out(temporary);
    for (const Grasp& g : part.grasps) {
      out << "[[grasp]]\nname = \"" << g.name << "\"\n";
      write_vector(out, "position_mm", g.T_part_gripper.translation_mm);
      write_vector(out, "approach", g.T_part_gripper.rotation.col(2));
      write_vector(out, "closing", g.T_part_gripper.rotation.col(0));
      out << "opening_mm = " << g.opening_mm << "\n\n";
    }
    if (!out) return failure(ResultCode::kFileNotWritten, "%s: cannot be written; check the folder", file.c_str());
  }
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) return failure(ResultCode::kFileNotWritten, "%s: %s", file.c_str(), error.message().c_str());
  return {};
}

}  // namespace

std::vector<std::string> builtin_part_names() {
  std::vector<std::string> names;
  for (const Builtin& builtin : kBuiltins) names.emplace_back(builtin.name);
  return names;
}

Result<ScenePart> builtin_part(const std::string& name) {
  const auto* builtin =
      std::find_if(kBuiltins.begin(), kBuiltins.end(), [&](const Builtin& b) { return name == b.name; });
  if (builtin == kBuiltins.end()) {
    std::string known;
    for (const Builtin& b : kBuiltins) known += std::string(b.name) + ", ";
    return failure(ResultCode::kUsage, "part %s: expected %sor a mesh file", name.c_str(), known.c_str());
  }
  auto part = make_part(name, mesh_of_solid(builtin->distance, builtin->box(), builtin->cell_mm));
  if (!part) return part;
  part->grasps = builtin->grasps();
  if (name == "elbow") part->symmetries = {elbow_half_turn()};
  return part;
}

ScenePart mirrored(const ScenePart& part, std::string name) {
  const Vec3 flip(-1.0, 1.0, 1.0);
  Mesh mesh = part.mesh;
  mesh.vertex_normal.clear();
  for (Vec3f& vertex : mesh.vertex_mm) vertex.x() = -vertex.x();
  for (auto& face : mesh.face) std::swap(face[1], face[2]);
  ScenePart twin = *make_part(std::move(name), std::move(mesh));  // as sound as the part itself
  for (const auto& turn : part.symmetries) {
    const Mat3 rotation = flip.asDiagonal() * turn.rotation * flip.asDiagonal();
    twin.symmetries.push_back({rotation, flip.cwiseProduct(turn.translation_mm)});
  }
  for (const Grasp& g : part.grasps) {
    const Mat3& axes = g.T_part_gripper.rotation;
    twin.grasps.push_back(grasp(g.name, flip.cwiseProduct(g.T_part_gripper.translation_mm),
                                flip.cwiseProduct(Vec3(axes.col(2))), flip.cwiseProduct(Vec3(axes.col(0))),
                                g.opening_mm));
  }
  twin.finish = part.finish;
  return twin;
}

Result<ScenePart> load_part(const std::string& name_or_file, double mm_per_unit) {
  const std::filesystem::path path(name_or_file);
  if (path.extension().empty()) return builtin_part(name_or_file);
  auto mesh = contract_io::read_mesh(path, mm_per_unit);
  if (!mesh) return std::unexpected(mesh.error());
  return make_part(path.stem().string(), std::move(*mesh));
}

Result<void> write_part(const ScenePart& part, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return failure(ResultCode::kFileNotWritten, "%s: %s", folder.c_str(), error.message().c_str());
  if (auto written = contract_io::write_stl(folder / (part.name + ".stl"), part.mesh); !written) return written;
  if (part.grasps.empty()) return {};
  return write_grasps(part, folder / (part.name + ".grasps.toml"));
}

}  // namespace beltpick::virtual_cell
