// The header of a .npy file (NumPy's format 1.0 to 3.0): a Python dictionary of descr, fortran_order and shape.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace beltpick::contract_io {

struct NpyHeader {
  std::string descr;
  bool fortran_order = false;
  std::vector<long long> shape;
  std::size_t data_at = 0;  // where the values begin
};

// Error: kFormatInvalid. `name` stands in messages.
Result<NpyHeader> parse_npy_header(std::string_view bytes, const std::string& name);

// A header of format 1.0, padded so that the values are aligned to 64 bytes.
std::string npy_header_text(const std::string& descr, std::initializer_list<int> shape);

}  // namespace beltpick::contract_io
