// JSON for people and machines: members in the order given, a matrix or a short object on one line.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/pose.hpp"

namespace beltpick::contract_io {

using Json = nlohmann::ordered_json;

// The text of `value`, ending with a newline. Values that JSON lacks (NaN, infinity) become null.
std::string json_text(const Json& value);

// Rows of a matrix, nested.
template <class Matrix>
Json json_matrix(const Matrix& matrix) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(static_cast<double>(matrix(r, c)));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace beltpick::contract_io
