#include <array>
#include <charconv>
#include <cstring>
#include <sstream>
#include <unordered_map>

#include "contract/result_codes.hpp"
#include "contract_io/mesh_parts.hpp"

namespace beltpick::contract_io {

namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;

struct VertexHash {
  std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
    return (bits[0] * 73856093ULL) ^ (bits[1] * 19349663ULL) ^ (bits[2] * 83492791ULL);
  }
};

// STL repeats every vertex in every facet; the mesh wants each once.
class VertexMerger {
 public:
  explicit VertexMerger(Mesh& mesh) : mesh_(mesh) {}

  std::uint32_t index(Vec3f vertex) {
    vertex += Vec3f::Zero();  // -0 and 0 are one place
    std::array<std::uint32_t, 3> bits{};
    std::memcpy(bits.data(), vertex.data(), sizeof bits);
    const auto [at, fresh] = seen_.try_emplace(bits, static_cast<std::uint32_t>(mesh_.vertex_mm.size()));
    if (fresh) mesh_.vertex_mm.push_back(vertex);
    return at->second;
  }

 private:
  Mesh& mesh_;
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, VertexHash> seen_;
};

std::size_t binary_facets(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

Mesh read_binary(std::string_view bytes) {
  Mesh mesh;
  VertexMerger merger(mesh);
  const std::size_t facets = binary_facets(bytes);
  mesh.face.reserve(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    const char* facet = bytes.data() + kHeaderBytes + f * kFacetBytes + 12;  // after the facet's own normal
    std::array<std::uint32_t, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3f vertex;
      std::memcpy(vertex.data(), facet + 12 * k, 12);
      face[k] = merger.index(vertex);
    }
    mesh.face.push_back(face);
  }
  return mesh;
}

Result<Mesh> read_ascii(std::string_view bytes, const std::string& name) {
  Mesh mesh;
  VertexMerger merger(mesh);
  std::istringstream stream{std::string(bytes)};
  std::string word;
  std::array<std::uint32_t, 3> face{};
  std::size_t corner = 0;
  while (stream >> word) {
    if (word == "facet") corner = 0;
    if (word != "vertex") continue;
    Vec3f vertex;
    if (!(stream >> vertex.x() >> vertex.y() >> vertex.z())) {
      return failure(ResultCode::kFormatInvalid,
                     "%s: facet %zu: expected three numbers after 'vertex'; export it again", name.c_str(),
                     mesh.face.size() + 1);
    }
    face[corner % 3] = merger.index(vertex);
    if (++corner == 3) mesh.face.push_back(face);
  }
  return mesh;
}

}  // namespace

Result<Mesh> parse_stl(std::string_view bytes, const std::string& name) {
  // A binary file may begin with "solid" too; only its size tells.
  if (bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + binary_facets(bytes) * kFacetBytes) {
    return read_binary(bytes);
  }
  const std::string_view start = bytes.substr(0, bytes.find_first_not_of(" \t\r\n") + 6);
  const bool text = bytes.substr(0, 512).find('\0') == std::string_view::npos;
  if (text && start.find("solid") != std::string_view::npos) return read_ascii(bytes, name);
  if (!text && bytes.size() >= kHeaderBytes) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: binary STL: expected %zu bytes for its %zu facets, found %zu; the file is cut or damaged",
                   name.c_str(), kHeaderBytes + binary_facets(bytes) * kFacetBytes, binary_facets(bytes), bytes.size());
  }
  return failure(ResultCode::kFormatInvalid,
                 "%s: neither binary STL nor text that begins with 'solid'; export it as STL", name.c_str());
}

}  // namespace beltpick::contract_io
