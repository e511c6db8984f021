// The checks of `beltpick doctor`: what can be seen from here, one after the other, then the appliance's own self-test.
#pragma once

#include <string>
#include <vector>

#include "link/http_client.hpp"

namespace beltpick::cli {

struct DoctorCheck {
  std::string side;     // "here" or "appliance"
  std::string name;     // "port", "certificate", ...
  std::string verdict;  // "good", "warning", "failed", "skipped"
  std::string found, cause, remedy;
};

// Goes on as far as an earlier failure lets it. `meanwhile` is called now and then while the self-test runs.
std::vector<DoctorCheck> doctor_checks(const link::Address& address, const link::Progress& meanwhile);

}  // namespace beltpick::cli
