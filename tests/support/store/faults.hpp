// One upload or removal, disturbed at every place where it can be: each function tries all of them, opens the store
// after each, and says what was not as it must be.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "support/store/expected.hpp"

namespace beltpick::test {

// A store with the versions `before`, in which `next` is put (or, for a removal, removed).
struct DisturbedStep {
  std::string name;
  std::vector<ExpectedVersion> before;  // numbered from 1
  ExpectedVersion next;

  static constexpr int kKeep = 3;
};

// The first version ever, a second one, one that pushes the oldest out, a removal; of `bytes` each.
std::vector<DisturbedStep> disturbed_steps(std::size_t bytes);

struct FaultCounts {
  std::string trouble;  // empty: none
  int cases = 0;
  int came_new = 0;  // cases after which the new version was there; in the others the old one
};

// kill -9 before and after every call that changes the disk.
FaultCounts kill_at_every_call(const std::filesystem::path& folder, const DisturbedStep& step);
// kill -9 within the write of the file, after each of its bytes.
FaultCounts kill_at_every_byte(const std::filesystem::path& folder, const DisturbedStep& step);
// Every call fails once, or it and all after it, for lack of room or a defective disk; a write also after a part of its
// bytes. The store says so, has the old version, and takes the new one when the disk works again.
FaultCounts fail_at_every_call(const std::filesystem::path& folder, const DisturbedStep& step);
// The file ends at each of its bytes because the process may write no longer ones (RLIMIT_FSIZE): no seam of ours.
FaultCounts limit_at_every_byte(const std::filesystem::path& folder, const DisturbedStep& step);
// Power cut after every call; of bytes on their way every `byte_step`th cut.
FaultCounts cut_power_at_every_call(const std::filesystem::path& folder, const DisturbedStep& step,
                                    std::size_t byte_step);
// `uploads` uploads and removals, each ended by a power cut after a random call, with a random one of the states that
// it can leave; the next begins on that, so that what a cut leaves meets opening, writing and the next cut.
FaultCounts cut_power_again_and_again(const std::filesystem::path& folder, int uploads, std::uint32_t seed);
// The newest version's file cut at each byte, and each of its bits flipped (one of every `bit_step`): it is set aside.
FaultCounts damage_every_byte(const std::filesystem::path& folder, const DisturbedStep& step, std::size_t bit_step);

}  // namespace beltpick::test
