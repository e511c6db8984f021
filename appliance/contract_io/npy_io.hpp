// NumPy's .npy: C-order little-endian arrays of float32, uint16 and uint8.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace beltpick::contract_io {

template <class T>
struct NpyArray {
  std::vector<int> shape;
  std::vector<T> values;  // C order: the last index runs fastest
};

// Reads an array of T (float, uint16_t or uint8_t). `shape` is what is expected, -1 where any length will do, e.g.
// {-1, -1, 3}. Other element types, Fortran order and other shapes are refused, not converted.
// Errors: kFileNotFound, kFileUnreadable, kFormatInvalid.
template <class T>
Result<NpyArray<T>> read_npy(const std::filesystem::path& path, std::initializer_list<int> shape);
// The same from memory; `name` stands in messages.
template <class T>
Result<NpyArray<T>> decode_npy(std::string_view bytes, const std::string& name, std::initializer_list<int> shape);

// Writes values of the given shape, complete or not at all. Error: kFileNotWritten.
template <class T>
Result<void> write_npy(const std::filesystem::path& path, std::span<const T> values, std::initializer_list<int> shape);

}  // namespace beltpick::contract_io
