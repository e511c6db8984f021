// The parsers that read_mesh chooses from, each in a source file of its own. Coordinates as they stand in the file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "contract/mesh.hpp"

namespace beltpick::contract_io {

// `name` is the file as errors call it.
Result<Mesh> parse_stl(std::string_view bytes, const std::string& name);
Result<Mesh> parse_ply(std::string_view bytes, const std::string& name);
Result<Mesh> parse_obj(std::string_view bytes, const std::string& name);

// Adds a polygon, which need not be convex, to mesh.face as triangles that cover it and keep its sense of turning. A
// corner that is no vertex goes into a face all the same, for the check of the whole mesh to name.
void add_polygon(const std::vector<std::uint32_t>& corners, Mesh& mesh);

}  // namespace beltpick::contract_io
