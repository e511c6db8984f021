// The benches' way with failures: one line and the end.
#pragma once

#include <stdexcept>
#include <utility>

#include "base/result.hpp"

namespace beltpick::bench {

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  throw std::runtime_error(result.error().detail);
}
inline void need(const Result<void>& result) {
  if (!result) throw std::runtime_error(result.error().detail);
}

}  // namespace beltpick::bench
