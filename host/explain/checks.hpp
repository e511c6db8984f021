// What verification asked of a pose: each value against its threshold.
#pragma once

#include <string>
#include <vector>

#include "result/verdict.hpp"

namespace beltpick::explain {

struct Check {
  const char* name;     // as explain.json calls it
  const char* meaning;  // for a person
  double value;
  double limit;
  bool at_least;     // else at most
  const char* unit;  // "%" (values are shares), "mm", "mm2" or ""

  [[nodiscard]] bool passed() const { return at_least ? value >= limit : value <= limit; }
};

std::vector<Check> checks_of(const result::Evidence& evidence, double tolerance_mm, const Requirements& required);

}  // namespace beltpick::explain
