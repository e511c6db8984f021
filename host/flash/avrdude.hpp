// Runs avrdude: how far it is, and in one line what went wrong.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "flash/programmer.hpp"

namespace beltpick::flash {

// How far avrdude is, from what it prints: fifty '#' while it writes, fifty while it reads back.
class AvrdudeProgress {
 public:
  // Takes more of its output; percent of the whole.
  int take(std::string_view output);

 private:
  enum class Phase { kBefore, kWriting, kReading };

  Phase phase_ = Phase::kBefore;
  std::string tail_;  // the last letters, in which a phase's name may be cut in two
  int marks_ = 0;
};

// Its complaint in its own words, from all that it printed; empty when it made none.
std::string avrdude_complaint(const std::string& output);

// Whether avrdude is there. Error: kFileNotFound, with the package to install.
Result<std::string> find_avrdude();

// Runs it for the job; `percent` is told as it goes. Error: kUpdateFailed with avrdude's complaint, or where it heard
// nothing of the board for too long.
Result<void> run_avrdude(const AvrdudeJob& job, const std::function<void(int)>& percent);

}  // namespace beltpick::flash
