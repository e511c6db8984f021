#include "service/self_test.hpp"

#include <algorithm>
#include <array>

namespace beltpick::service {

std::string_view verdict_name(Verdict verdict) {
  static constexpr auto kNames = std::to_array<std::string_view>({"good", "warning", "failed", "skipped"});
  return kNames[static_cast<std::size_t>(verdict)];
}

Verdict SelfTestReport::worst() const {
  Verdict worst = Verdict::kGood;
  for (const Check& check : checks) {
    if (check.verdict != Verdict::kSkipped) worst = std::max(worst, check.verdict);
  }
  return worst;
}

}  // namespace beltpick::service
