#include "contract_io/mesh_io.hpp"

#include <algorithm>
#include <cstring>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/mesh_parts.hpp"

namespace beltpick::contract_io {

namespace {

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Result<Mesh> parse(const std::filesystem::path& path, const std::string& bytes) {
  const std::string extension = extension_of(path);
  if (extension == ".stl") return parse_stl(bytes, one_line(path.string()));
  if (extension == ".ply") return parse_ply(bytes, one_line(path.string()));
  if (extension == ".obj") return parse_obj(bytes, one_line(path.string()));
  const char* name = extension == ".step" || extension == ".stp" || extension == ".iges" || extension == ".igs"
                         ? "found a CAD model; save it from CAD as STL, 0.05 mm of deviation or less"
                         : "found another ending; convert it to one of these";
  return failure(ResultCode::kFormatInvalid, "%s: expected a file ending in .stl, .ply or .obj, %s",
                 one_line(path.string()).c_str(), name);
}

// Faces without area carry no surface and no normal.
bool degenerate(const Mesh& mesh, const std::array<std::uint32_t, 3>& face) {
  const Vec3 a = (mesh.vertex_mm[face[1]] - mesh.vertex_mm[face[0]]).cast<double>();
  const Vec3 b = (mesh.vertex_mm[face[2]] - mesh.vertex_mm[face[0]]).cast<double>();
  return !(a.cross(b).squaredNorm() > 0.0);
}

Result<void> check(const Mesh& mesh, const std::string& name) {
  if (mesh.vertex_mm.empty())
    return failure(ResultCode::kMeshInvalid, "%s: expected a surface, found no points at all; export the part again",
                   name.c_str());
  for (std::size_t i = 0; i < mesh.vertex_mm.size(); ++i) {
    if (!mesh.vertex_mm[i].allFinite()) {
      return failure(ResultCode::kMeshInvalid, "%s: vertex %zu is not a finite number; export it again", name.c_str(),
                     i);
    }
  }
  for (std::size_t f = 0; f < mesh.face.size(); ++f) {
    for (const std::uint32_t index : mesh.face[f]) {
      if (index >= mesh.vertex_mm.size()) {
        return failure(ResultCode::kMeshInvalid, "%s: face %zu names vertex %u, but there are %zu; export it again",
                       name.c_str(), f, index, mesh.vertex_mm.size());
      }
    }
  }
  return {};
}

}  // namespace

Result<Mesh> read_mesh(const std::filesystem::path& path, double mm_per_unit) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  if (bytes->empty()) {
    return failure(ResultCode::kFormatInvalid, "%s: expected a mesh, found an empty file; export the part again",
                   one_line(path.string()).c_str());
  }
  auto mesh = parse(path, *bytes);
  if (!mesh) return mesh;
  const bool had_faces = !mesh->face.empty();
  if (auto checked = check(*mesh, one_line(path.string())); !checked) return std::unexpected(checked.error());
  mesh->dropped_faces = std::erase_if(mesh->face, [&](const auto& face) { return degenerate(*mesh, face); });
  const bool is_scan = extension_of(path) == ".ply" && !had_faces;
  if (mesh->face.empty() && !is_scan) {
    return failure(ResultCode::kMeshInvalid,
                   "%s: expected triangles, found none with an area; export the part's surface",
                   one_line(path.string()).c_str());
  }
  for (Vec3f& vertex : mesh->vertex_mm) vertex *= static_cast<float>(mm_per_unit);
  return mesh;
}

Result<void> write_stl(const std::filesystem::path& path, const Mesh& mesh) {
  std::string bytes(80, '\0');
  const auto append = [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); };
  const auto count = static_cast<std::uint32_t>(mesh.face.size());
  append(&count, 4);
  for (const auto& face : mesh.face) {
    const Vec3f a = mesh.vertex_mm[face[0]];
    const Vec3f b = mesh.vertex_mm[face[1]];
    const Vec3f c = mesh.vertex_mm[face[2]];
    const Vec3f normal = (b - a).cross(c - a).normalized();
    for (const Vec3f* v : {&normal, &a, &b, &c}) append(v->data(), 12);
    bytes.append(2, '\0');
  }
  return write_file(path, bytes);
}

}  // namespace beltpick::contract_io
