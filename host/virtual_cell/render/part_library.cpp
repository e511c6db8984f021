// The built-in parts with their symmetries and grasps, and parts from files.
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

// Half a turn about the bisector of the two flanges.
Pose<frame::Part, frame::Part> elbow_half_turn() {
  const Vec3 bisector = Vec3(1.0, 1.0, 0.0).normalized();
  return {Eigen::AngleAxisd(kPi, bisector).toRotationMatrix(), Vec3::Zero()};
}

Result<ScenePart> meshed(const std::string& name, const SignedDistance& solid, const Eigen::AlignedBox3d& box) {
  return make_part(name, mesh_of_solid(solid, box, kCellMm));
}

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

std::vector<std::string> builtin_part_names() { return {"knuckle", "elbow", "bracket", "vblock"}; }

Result<ScenePart> builtin_part(const std::string& name) {
  if (name == "knuckle") {
    auto part = meshed(name, knuckle_distance, knuckle_box());
    if (part) part->grasps = knuckle_grasps();
    return part;
  }
  if (name == "elbow") {
    auto part = meshed(name, elbow_distance, elbow_box());
    if (part) part->symmetries = {elbow_half_turn()};
    if (part) part->grasps = elbow_grasps();
    return part;
  }
  if (name == "bracket") {
    auto part = meshed(name, bracket_distance, bracket_box());
    if (part) part->grasps = bracket_grasps();
    return part;
  }
  if (name == "vblock") {
    auto part = meshed(name, vblock_distance, vblock_box());
    if (part) part->grasps = vblock_grasps();
    return part;
  }
  return failure(ResultCode::kUsage, "part %s: expected knuckle, elbow, bracket, vblock or a mesh file", name.c_str());
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
