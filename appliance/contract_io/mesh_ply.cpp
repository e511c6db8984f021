#include <algorithm>
#include <bit>
#include <cstring>
#include <sstream>

#include "contract/result_codes.hpp"
#include "contract_io/mesh_parts.hpp"

namespace beltpick::contract_io {

namespace {

enum class Encoding { kAscii, kLittle, kBig };

struct Property {
  std::string name;
  std::string type;
  std::string count_type;  // empty unless a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  std::size_t body = 0;  // offset of the first byte after the header
};

std::size_t size_of(const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "double" || type == "float64") return 8;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32" || type == "float" || type == "float32")
    return 4;
  return 0;
}

Result<Header> parse_header(std::string_view bytes, const std::string& name) {
  Header header;
  std::size_t at = 0;
  for (int line_number = 1;; ++line_number) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos || line_number > 1000) {
      return failure(ResultCode::kFormatInvalid, "%s: PLY: expected 'end_header', found the end of the file",
                     name.c_str());
    }
    std::istringstream line{std::string(bytes.substr(at, end - at))};
    at = end + 1;
    std::string word;
    std::string second;
    line >> word >> second;
    if (line_number == 1 && word != "ply") {
      return failure(ResultCode::kFormatInvalid, "%s: expected a file that begins with 'ply'", name.c_str());
    }
    if (word == "end_header") break;
    if (word == "format") {
      if (second != "ascii" && second != "binary_little_endian" && second != "binary_big_endian") {
        return failure(ResultCode::kFormatInvalid, "%s: PLY: unknown format '%.40s'", name.c_str(), second.c_str());
      }
      header.encoding = second == "ascii"               ? Encoding::kAscii
                        : second == "binary_big_endian" ? Encoding::kBig
                                                        : Encoding::kLittle;
    } else if (word == "element") {
      Element element{second, 0, {}};
      line >> element.count;
      header.elements.push_back(element);
    } else if (word == "property" && !header.elements.empty()) {
      Property property;
      if (second == "list") {
        line >> property.count_type >> property.type >> property.name;
      } else {
        property.type = second;
        line >> property.name;
      }
      if (size_of(property.type) == 0 || (second == "list" && size_of(property.count_type) == 0)) {
        return failure(ResultCode::kFormatInvalid, "%s: PLY: header line %d: unknown property type", name.c_str(),
                       line_number);
      }
      header.elements.back().properties.push_back(property);
    }
  }
  header.body = at;
  return header;
}

// Reads one number after the other from the body, whatever its encoding.
class Body {
 public:
  Body(std::string_view bytes, Encoding encoding) : bytes_(bytes), encoding_(encoding) {}

  [[nodiscard]] bool failed() const { return failed_; }

  double number(const std::string& type) {
    return encoding_ == Encoding::kAscii ? ascii_number() : binary_number(type);
  }

 private:
  double ascii_number() {
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_])) != 0) ++at_;
    const std::size_t start = at_;
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_])) == 0) ++at_;
    const std::string word(bytes_.substr(start, at_ - start));
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    failed_ = failed_ || word.empty() || *end != '\0';
    return value;
  }

  double binary_number(const std::string& type) {
    std::array<char, 8> raw{};
    const std::size_t size = size_of(type);
    if (at_ + size > bytes_.size()) {
      failed_ = true;
      return 0;
    }
    std::memcpy(raw.data(), bytes_.data() + at_, size);
    at_ += size;
    if (encoding_ == Encoding::kBig) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    if (type == "char" || type == "int8") return as<std::int8_t>(raw);
    if (type == "uchar" || type == "uint8") return as<std::uint8_t>(raw);
    if (type == "short" || type == "int16") return as<std::int16_t>(raw);
    if (type == "ushort" || type == "uint16") return as<std::uint16_t>(raw);
    if (type == "int" || type == "int32") return as<std::int32_t>(raw);
    if (type == "uint" || type == "uint32") return as<std::uint32_t>(raw);
    if (type == "double" || type == "float64") return as<double>(raw);
    return as<float>(raw);
  }

  template <class T>
  static double as(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof value);
    return static_cast<double>(value);
  }

  std::string_view bytes_;
  Encoding encoding_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

void read_vertex(const Element& element, Body& body, bool has_normals, Mesh& mesh) {
  Vec3f vertex = Vec3f::Zero();
  Vec3f normal = Vec3f::Zero();
  for (const Property& property : element.properties) {
    const auto value = static_cast<float>(body.number(property.type));
    if (property.name == "x") vertex.x() = value;
    if (property.name == "y") vertex.y() = value;
    if (property.name == "z") vertex.z() = value;
    if (property.name == "nx") normal.x() = value;
    if (property.name == "ny") normal.y() = value;
    if (property.name == "nz") normal.z() = value;
  }
  mesh.vertex_mm.push_back(vertex);
  if (has_normals) mesh.vertex_normal.push_back(normal);
}

bool is_corners(const Property& property) {
  return property.name == "vertex_indices" || property.name == "vertex_index";
}

// Index of no vertex: refused when the mesh is checked.
constexpr std::uint32_t kNoVertex = 0xFFFFFFFFU;

void read_face(const Element& element, Body& body, Mesh& mesh, std::vector<std::uint32_t>& polygon) {
  for (const Property& property : element.properties) {
    if (property.count_type.empty()) {
      body.number(property.type);
      continue;
    }
    const auto count = static_cast<std::size_t>(std::max(0.0, body.number(property.count_type)));
    polygon.clear();
    for (std::size_t k = 0; k < count && !body.failed(); ++k) {
      const double value = body.number(property.type);
      polygon.push_back(value >= 0 && value < kNoVertex ? static_cast<std::uint32_t>(value) : kNoVertex);
    }
    if (is_corners(property)) add_polygon(polygon, mesh);
  }
}

bool has_property(const Element& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& p) { return p.name == name; });
}

// A surface told in another way than by faces must not pass for a scan without any.
Result<void> check_surface_elements(const Header& header, const std::string& name) {
  for (const Element& element : header.elements) {
    const bool faces = element.name == "face" && element.count > 0;
    if (element.name != "tristrips" &&
        (!faces || std::any_of(element.properties.begin(), element.properties.end(), is_corners))) {
      continue;
    }
    return failure(ResultCode::kFormatInvalid,
                   "%s: PLY: expected faces with a list 'vertex_indices', found element '%.40s' without; export "
                   "triangles",
                   name.c_str(), element.name.c_str());
  }
  return {};
}

}  // namespace

Result<Mesh> parse_ply(std::string_view bytes, const std::string& name) {
  auto header = parse_header(bytes, name);
  if (!header) return std::unexpected(header.error());
  if (auto known = check_surface_elements(*header, name); !known) return std::unexpected(known.error());
  Mesh mesh;
  std::vector<std::uint32_t> polygon;
  Body body(bytes.substr(header->body), header->encoding);
  for (const Element& element : header->elements) {
    const bool is_vertex = element.name == "vertex";
    if (is_vertex && (!has_property(element, "x") || !has_property(element, "y") || !has_property(element, "z"))) {
      return failure(ResultCode::kFormatInvalid, "%s: PLY: expected properties x, y, z of a vertex", name.c_str());
    }
    const bool has_normals = is_vertex && has_property(element, "nx") && has_property(element, "nz");
    for (std::size_t i = 0; i < element.count; ++i) {
      if (is_vertex) {
        read_vertex(element, body, has_normals, mesh);
      } else {
        read_face(element, body, mesh,
                  polygon);  // other elements are read past the same way: their lists carry other names
      }
      if (body.failed()) {
        return failure(ResultCode::kFormatInvalid,
                       "%s: PLY: expected %zu of element '%.40s', found %zu; the file is cut or damaged", name.c_str(),
                       element.count, element.name.c_str(), i);
      }
    }
  }
  return mesh;
}

}  // namespace beltpick::contract_io
