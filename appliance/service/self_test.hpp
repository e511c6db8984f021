// SelfTestReport: what a self-test found, check by check, each with its cause and remedy.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace beltpick::service {

enum class Verdict : std::uint8_t { kGood, kWarning, kFailed, kSkipped };

// "good", "warning", "failed", "skipped".
std::string_view verdict_name(Verdict verdict);

struct Check {
  std::string name;  // "camera", "packet size", ...
  Verdict verdict = Verdict::kGood;
  std::string found;   // what was measured, in words: "answers as BP-1001 at 127.0.0.1"
  std::string cause;   // why it is so, where it is not good
  std::string remedy;  // what to do
};

struct SelfTestReport {
  std::string time_utc;
  std::vector<Check> checks;

  // The worst of the checks; a skipped one is no worse than a good one.
  [[nodiscard]] Verdict worst() const;
};

}  // namespace beltpick::service
