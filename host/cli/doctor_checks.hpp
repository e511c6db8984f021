// The checks of `beltpick doctor`: what can be seen from here, one after the other, then the appliance's own self-test.
#pragma once

#include <string>
#include <vector>

#include "contract_io/json_writer.hpp"
#include "link/address.hpp"

namespace beltpick::cli {

struct DoctorCheck {
  std::string side;     // "here" or "appliance"
  std::string name;     // "port", "certificate", ...
  std::string verdict;  // "good", "warning", "failed", "skipped"
  std::string found, cause, remedy;
};

// Goes on as far as it can: what cannot be checked because of an earlier failure is "skipped".
std::vector<DoctorCheck> doctor_checks(const link::Address& address);

}  // namespace beltpick::cli
