// The parsers that read_mesh chooses from, each in a source file of its own. Coordinates as they stand in the file.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/mesh.hpp"

namespace beltpick::contract_io {

// `name` is the file as errors call it.
Result<Mesh> parse_stl(std::string_view bytes, const std::string& name);
Result<Mesh> parse_ply(std::string_view bytes, const std::string& name);
Result<Mesh> parse_obj(std::string_view bytes, const std::string& name);

}  // namespace beltpick::contract_io
