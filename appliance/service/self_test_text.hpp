// A self-test's report for machines, which is what the API serves and `beltpick doctor` reads, and for people.
#pragma once

#include <string>

#include "service/self_test.hpp"

namespace beltpick::service {

// {"format": "beltpick-self-test", "version": 1, "time": ..., "worst": the worst verdict, "checks": [{"name",
// "verdict": "good" | "warning" | "failed" | "skipped", "found", "cause", "remedy"}]}, ending with a newline. Cause and
// remedy are empty where there is nothing to mend.
std::string self_test_json(const SelfTestReport& report);
// The same form while no self-test has run: without checks, time and worst verdict null.
std::string self_test_json_before_any();

// A line for each check, with cause and remedy under those that are not good, and a line that counts the verdicts.
std::string self_test_table(const SelfTestReport& report);

}  // namespace beltpick::service
