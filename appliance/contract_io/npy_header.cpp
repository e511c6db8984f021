#include "contract_io/npy_header.hpp"

#include <cctype>

#include "contract/result_codes.hpp"

namespace beltpick::contract_io {
namespace {

constexpr std::string_view kMagic("\x93NUMPY", 6);

// What follows `'key':` in the dictionary, or nothing.
std::string_view member(std::string_view dictionary, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    std::size_t at = dictionary.find(quoted);
    if (at == std::string_view::npos) continue;
    at = dictionary.find_first_not_of(" ", at + quoted.size());
    if (at == std::string_view::npos || dictionary[at] != ':') continue;
    at = dictionary.find_first_not_of(" ", at + 1);
    if (at != std::string_view::npos) return dictionary.substr(at);
  }
  return {};
}

bool read_text(std::string_view value, std::string& out) {
  if (value.empty() || (value.front() != '\'' && value.front() != '"')) return false;
  const std::size_t end = value.find(value.front(), 1);
  if (end == std::string_view::npos) return false;
  out = value.substr(1, end - 1);
  return true;
}

bool read_flag(std::string_view value, bool& out) {
  out = value.starts_with("True");
  return out || value.starts_with("False");
}

bool read_shape(std::string_view value, std::vector<long long>& out) {
  const std::size_t end = value.find(')');
  if (!value.starts_with("(") || end == std::string_view::npos) return false;
  long long number = -1;
  for (const char c : value.substr(1, end)) {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      if (number > 1'000'000'000'000) return false;
      number = (number < 0 ? 0 : number) * 10 + (c - '0');
    } else if (c == ',' || c == ')') {
      if (number >= 0) out.push_back(number);
      number = -1;
    } else if (c != ' ' && c != 'L') {
      return false;
    }
  }
  return out.size() <= 8;
}

}  // namespace

Result<NpyHeader> parse_npy_header(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kMagic)) {
    return failure(ResultCode::kFormatInvalid, "%s: expected a NumPy .npy array, found %s; is it the right file?",
                   name.c_str(), bytes.empty() ? "an empty file" : "another format");
  }
  const auto byte = [&](std::size_t at) {
    return at < bytes.size() ? static_cast<std::size_t>(static_cast<unsigned char>(bytes[at])) : 0;
  };
  const bool wide = byte(6) >= 2;
  const std::size_t start = wide ? 12 : 10;
  const std::size_t length = byte(8) | byte(9) << 8U | (wide ? byte(10) << 16U | byte(11) << 24U : 0);
  if (byte(6) < 1 || byte(6) > 3 || start > bytes.size() || length > bytes.size() - start) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: expected a whole .npy header, found one cut off; write the file again", name.c_str());
  }
  const std::string_view dictionary = bytes.substr(start, length);
  NpyHeader header;
  header.data_at = start + length;
  const char* wrong = nullptr;
  if (!read_text(member(dictionary, "descr"), header.descr)) wrong = "descr";
  if (!read_flag(member(dictionary, "fortran_order"), header.fortran_order)) wrong = "fortran_order";
  if (!read_shape(member(dictionary, "shape"), header.shape)) wrong = "shape";
  if (wrong != nullptr) {
    return failure(ResultCode::kFormatInvalid,
                   "%s: %s: expected a readable member in the .npy header, found none; write the file with numpy.save",
                   name.c_str(), wrong);
  }
  return header;
}

std::string npy_header_text(const std::string& descr, std::initializer_list<int> shape) {
  std::string dictionary = "{'descr': '" + descr + "', 'fortran_order': False, 'shape': (";
  for (const int length : shape) dictionary += std::to_string(length) + ", ";
  dictionary += "), }";
  constexpr std::size_t kPreamble = 10;
  const std::size_t padded = (kPreamble + dictionary.size() + 1 + 63) / 64 * 64;
  dictionary.append(padded - kPreamble - dictionary.size() - 1, ' ');
  dictionary += '\n';
  std::string header(kMagic);
  header += '\x01';
  header += '\0';
  header += static_cast<char>(dictionary.size() & 0xffU);
  header += static_cast<char>(dictionary.size() >> 8U);
  return header + dictionary;
}

}  // namespace beltpick::contract_io
