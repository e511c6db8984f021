// Meshes and scans from files: STL (ASCII and binary), PLY (ASCII, binary of either byte order), OBJ.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "contract/mesh.hpp"

namespace beltpick::contract_io {

// Reads a mesh by its extension and scales it: one unit of the file is `mm_per_unit` millimetres. Equal vertices of an
// STL are merged, faces without area dropped. A PLY without faces is a scan: its normals are read where it has them.
// Errors: kFileNotFound, kFileUnreadable, kFormatInvalid, kMeshInvalid (nothing in it, not finite, an index out of
// range).
Result<Mesh> read_mesh(const std::filesystem::path& path, double mm_per_unit);

// Writes binary STL in millimetres, by way of a temporary file. Errors: kFileNotWritten.
Result<void> write_stl(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace beltpick::contract_io
