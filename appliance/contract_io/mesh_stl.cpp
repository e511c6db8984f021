#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <unordered_map>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
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

std::string lower(std::string_view text) {
  std::string lowered(text);
  std::transform(lowered.begin(), lowered.end(), lowered.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lowered;
}

// Takes a text apart at its white space.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  // The next word; empty at the end.
  std::string_view next() {
    while (at_ < text_.size() && space(text_[at_])) ++at_;
    const std::size_t start = at_;
    while (at_ < text_.size() && !space(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

 private:
  static bool space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
  std::string_view text_;
  std::size_t at_ = 0;
};

bool number(std::string_view word, float& value) {
  const std::string terminated(word);
  char* end = nullptr;
  value = std::strtof(terminated.c_str(), &end);
  return !word.empty() && *end == '\0';
}

Result<Mesh> read_ascii(std::string_view bytes, const std::string& name) {
  Mesh mesh;
  VertexMerger merger(mesh);
  Words words(bytes);
  std::array<std::uint32_t, 3> face{};
  std::size_t corners = 0;
  bool ended = false;
  for (std::string_view next = words.next(); !next.empty(); next = words.next()) {
    const std::string word = lower(next);
    ended = ended || word == "endsolid";
    if (word == "facet") corners = 0;
    if (word == "vertex") {
      Vec3f vertex;
      for (float& coordinate : vertex) {
        const std::string_view text = words.next();
        if (number(text, coordinate)) continue;
        return failure(
            ResultCode::kFormatInvalid,
            "%s: facet %zu: expected three numbers with decimal points after 'vertex', found '%.20s'; export "
            "it again",
            name.c_str(), mesh.face.size() + 1, one_line(std::string(text)).c_str());
      }
      if (corners < 3) face[corners] = merger.index(vertex);
      ++corners;
    }
    if (word != "endfacet") continue;
    if (corners != 3) {
      return failure(ResultCode::kFormatInvalid, "%s: facet %zu: expected 3 vertices, found %zu; export triangles",
                     name.c_str(), mesh.face.size() + 1, corners);
    }
    mesh.face.push_back(face);
  }
  if (mesh.face.empty()) {
    return failure(ResultCode::kMeshInvalid,
                   "%s: begins with 'solid' as STL does, but holds no facets; export the part's surface", name.c_str());
  }
  if (!ended) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: expected 'endsolid' at the end, found the file's end after %zu facets; the file is cut",
                   name.c_str(), mesh.face.size());
  }
  return mesh;
}

}  // namespace

Result<Mesh> parse_stl(std::string_view bytes, const std::string& name) {
  // A binary file may begin with "solid" too; only its size tells.
  if (bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + binary_facets(bytes) * kFacetBytes) {
    return read_binary(bytes);
  }
  const std::string start = lower(bytes.substr(0, 512));
  const bool text = start.find('\0') == std::string::npos;
  if (text && start.compare(std::min(start.find_first_not_of(" \t\r\n"), start.size()), 5, "solid") == 0) {
    return read_ascii(bytes, name);
  }
  if (!text && bytes.size() >= kHeaderBytes) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: binary STL: expected %zu bytes for the %zu facets it announces, found %zu; the file is cut or "
                   "damaged, export it again",
                   name.c_str(), kHeaderBytes + binary_facets(bytes) * kFacetBytes, binary_facets(bytes), bytes.size());
  }
  return failure(ResultCode::kFormatInvalid,
                 "%s: neither binary STL nor text that begins with 'solid'; export the part as STL", name.c_str());
}

}  // namespace beltpick::contract_io
