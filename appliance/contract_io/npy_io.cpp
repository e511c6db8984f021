#include "contract_io/npy_io.hpp"

#include <bit>
#include <cstring>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/npy_header.hpp"

namespace beltpick::contract_io {
namespace {

static_assert(std::endian::native == std::endian::little, "npy values are copied as they are");

template <class T>
constexpr const char* descr_of();
template <>
constexpr const char* descr_of<float>() {
  return "<f4";
}
template <>
constexpr const char* descr_of<std::uint16_t>() {
  return "<u2";
}
template <>
constexpr const char* descr_of<std::uint8_t>() {
  return "|u1";
}

template <class T>
constexpr const char* dtype_of() {
  return std::is_same_v<T, float> ? "float32" : (sizeof(T) == 2 ? "uint16" : "uint8");
}

std::string shape_text(std::span<const long long> shape) {
  std::string text = "(";
  for (const long long length : shape) {
    if (text.size() > 1) text += ", ";
    text += length < 0 ? "any" : std::to_string(length);
  }
  return text + ")";
}

bool fits(std::span<const long long> found, std::span<const long long> expected) {
  if (found.size() != expected.size()) return false;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] < 1 || found[i] > 1'000'000 || (expected[i] >= 0 && expected[i] != found[i])) return false;
  }
  return true;
}

bool same_dtype(const std::string& found, const std::string& expected) {
  return found == expected || (expected == "|u1" && (found == "u1" || found == "<u1"));
}

}  // namespace

template <class T>
Result<NpyArray<T>> decode_npy(std::string_view bytes, const std::string& name, std::initializer_list<int> shape) {
  const auto header = parse_npy_header(bytes, name);
  if (!header) return std::unexpected(header.error());
  if (!same_dtype(header->descr, descr_of<T>())) {
    return failure(ResultCode::kFormatInvalid, "%s: dtype: expected %s ('%s'), found '%s'; save it with .astype('%s')",
                   name.c_str(), dtype_of<T>(), descr_of<T>(), one_line(header->descr).substr(0, 24).c_str(),
                   descr_of<T>());
  }
  const std::vector<long long> expected(shape.begin(), shape.end());
  if (!fits(header->shape, expected)) {
    return failure(ResultCode::kFormatInvalid, "%s: shape: expected %s, found %s; save the array in that shape",
                   name.c_str(), shape_text(expected).c_str(), shape_text(header->shape).substr(0, 60).c_str());
  }
  if (header->fortran_order) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: fortran_order: expected False, found True; save it with np.ascontiguousarray", name.c_str());
  }
  NpyArray<T> array;
  std::size_t count = 1;
  for (const long long length : header->shape) {
    array.shape.push_back(static_cast<int>(length));
    count *= static_cast<std::size_t>(length);  // at most 1e6 each, at most 3 of them: no overflow
  }
  const std::size_t found = bytes.size() - header->data_at;
  if (found != count * sizeof(T)) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: data: expected %zu bytes for shape %s, found %zu; write the file again", name.c_str(),
                   count * sizeof(T), shape_text(header->shape).c_str(), found);
  }
  array.values.resize(count);
  std::memcpy(array.values.data(), bytes.data() + header->data_at, found);
  return array;
}

template <class T>
Result<NpyArray<T>> read_npy(const std::filesystem::path& path, std::initializer_list<int> shape) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  return decode_npy<T>(*bytes, one_line(path.string()), shape);
}

template <class T>
Result<void> write_npy(const std::filesystem::path& path, std::span<const T> values, std::initializer_list<int> shape) {
  std::string bytes = npy_header_text(descr_of<T>(), shape);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return write_file(path, bytes);
}

template Result<NpyArray<float>> decode_npy<float>(std::string_view, const std::string&, std::initializer_list<int>);
template Result<NpyArray<std::uint16_t>> decode_npy<std::uint16_t>(std::string_view, const std::string&,
                                                                   std::initializer_list<int>);
template Result<NpyArray<std::uint8_t>> decode_npy<std::uint8_t>(std::string_view, const std::string&,
                                                                 std::initializer_list<int>);
template Result<NpyArray<float>> read_npy<float>(const std::filesystem::path&, std::initializer_list<int>);
template Result<NpyArray<std::uint16_t>> read_npy<std::uint16_t>(const std::filesystem::path&,
                                                                 std::initializer_list<int>);
template Result<NpyArray<std::uint8_t>> read_npy<std::uint8_t>(const std::filesystem::path&,
                                                               std::initializer_list<int>);
template Result<void> write_npy<float>(const std::filesystem::path&, std::span<const float>,
                                       std::initializer_list<int>);
template Result<void> write_npy<std::uint16_t>(const std::filesystem::path&, std::span<const std::uint16_t>,
                                               std::initializer_list<int>);
template Result<void> write_npy<std::uint8_t>(const std::filesystem::path&, std::span<const std::uint8_t>,
                                              std::initializer_list<int>);

}  // namespace beltpick::contract_io
