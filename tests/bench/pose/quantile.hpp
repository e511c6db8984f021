// Quantiles of what was measured.
#pragma once

#include <algorithm>
#include <vector>

namespace beltpick::bench {

// The smallest value that a share `q` of the values lies below; 0 without values.
inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at = std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

}  // namespace beltpick::bench
