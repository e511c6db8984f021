#include <sstream>

#include "contract/result_codes.hpp"
#include "contract_io/mesh_parts.hpp"

namespace beltpick::contract_io {

namespace {

// "7", "7/2", "7//3", "-1": the vertex index, from 1 or from the end; 0 where it is none of these.
long vertex_index(const std::string& corner) {
  try {
    return std::stol(corner);
  } catch (const std::exception&) {
    return 0;
  }
}

// The corners of one line.
Result<void> add_face(std::istringstream& line, std::size_t line_number, const std::string& name, Mesh& mesh) {
  std::vector<std::uint32_t> polygon;
  std::string corner;
  while (line >> corner) {
    const long index = vertex_index(corner);
    const long count = static_cast<long>(mesh.vertex_mm.size());
    const long resolved = index < 0 ? count + index : index - 1;
    if (index == 0 || resolved < 0 || resolved >= count) {
      return failure(ResultCode::kFormatInvalid,
                     "%s: line %zu: expected a vertex number from 1 to %ld, found '%.40s'; export "
                     "it again",
                     name.c_str(), line_number, count, corner.c_str());
    }
    polygon.push_back(static_cast<std::uint32_t>(resolved));
  }
  add_polygon(polygon, mesh);
  return {};
}

}  // namespace

Result<Mesh> parse_obj(std::string_view bytes, const std::string& name) {
  Mesh mesh;
  std::istringstream stream{std::string(bytes)};
  std::string text;
  for (std::size_t line_number = 1; std::getline(stream, text); ++line_number) {
    std::istringstream line(text);
    std::string keyword;
    line >> keyword;
    if (keyword == "v") {
      Vec3f vertex;
      if (!(line >> vertex.x() >> vertex.y() >> vertex.z())) {
        return failure(ResultCode::kFormatInvalid,
                       "%s: line %zu: expected three finite numbers after 'v'; export it again", name.c_str(),
                       line_number);
      }
      mesh.vertex_mm.push_back(vertex);
    } else if (keyword == "f") {
      if (auto added = add_face(line, line_number, name, mesh); !added) return std::unexpected(added.error());
    }
  }
  return mesh;
}

}  // namespace beltpick::contract_io
