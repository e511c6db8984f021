#include "calibrate/calibrate.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/first_guess.hpp"
#include "calibrate/held_out.hpp"
#include "calibrate/judge.hpp"
#include "calibrate/outcome_parts.hpp"
#include "calibrate/sift.hpp"

namespace beltpick::calibrate {
namespace {

constexpr int kMaxRounds = 12;
constexpr double kFirstWorst_px = 3.0;  // a linear first guess may be off by so much where lenses distort
constexpr double kWorst_px = 0.25;
constexpr int kShapePoses = 4;  // fewer do not tell a bent plate from a wrong lens

// Poses so wrong that the first guess suffers: found with it, and it is made anew without them.
Result<BundleState> guess_without_bad_poses(const Observations& seen, Selection& use, std::vector<LeftOut>& left_out) {
  for (;;) {
    auto guess = first_guess(seen, use);
    if (!guess || count_poses(use) <= kLeastPoses) return guess;
    const BundleOptions rigid{.max_steps = 10, .plate_shape = false};
    const BundleResult rough = refine(seen, use, {1.0, 1.0}, *guess, rigid);
    if (!leave_out_pose(seen, rough.state, kFirstWorst_px, use, left_out)) return rough.state;
  }
}

struct Solution {
  BundleResult bundle;
  BundleNoise noise;
  BundleOptions options;
};

// Refines and sifts until neither the choice nor the noise changes any more.
Solution solve(const Observations& seen, BundleState start, Selection& use, std::vector<LeftOut>& left_out) {
  Solution solution{{std::move(start), false, {}}, {1.0, 1.0}, {}};
  for (int round = 0; round < kMaxRounds; ++round) {
    solution.options.plate_shape = count_poses(use) >= kShapePoses;
    solution.bundle = refine(seen, use, solution.noise, solution.bundle.state, solution.options);
    const BundleNoise noise = noise_of(seen, use, solution.bundle.state);
    const bool settled = std::abs(noise.camera_px / solution.noise.camera_px - 1.0) < 0.01 &&
                         std::abs(noise.projector_px / solution.noise.projector_px - 1.0) < 0.01;
    solution.noise = noise;
    if (leave_out_pose(seen, solution.bundle.state, kWorst_px, use, left_out)) continue;
    const bool changed = leave_out_corners(seen, solution.bundle.state, noise, use, left_out);
    if (settled && !changed) break;
  }
  return solution;
}

// Of a capture that is left out as a whole its corners need not be named too.
std::vector<LeftOut> without_repetition(std::vector<LeftOut> all) {
  std::vector<std::string> whole;
  for (const LeftOut& item : all) {
    if (item.corner < 0) whole.push_back(item.capture);
  }
  std::erase_if(all, [&](const LeftOut& item) {
    return item.corner >= 0 && std::find(whole.begin(), whole.end(), item.capture) != whole.end();
  });
  return all;
}

}  // namespace

Result<Outcome> calibrate(const Observations& seen, const StepDone& step_done) {
  std::vector<LeftOut> left_out = seen.left_out;
  Selection use = select_all(seen, left_out);
  if (auto enough = check_before(seen, use, left_out); !enough) return std::unexpected(enough.error());
  auto start = guess_without_bad_poses(seen, use, left_out);
  if (!start) return std::unexpected(start.error());
  const Solution solution = solve(seen, std::move(*start), use, left_out);
  if (auto enough = check_before(seen, use, left_out); !enough) return std::unexpected(enough.error());

  const int total = count_poses(use);
  int done = 0;
  const auto held_out = hold_poses_out(seen, use, solution.noise, solution.bundle.state, solution.options, [&] {
    if (step_done) step_done(++done, total);
  });
  Outcome outcome = gather(seen, use, solution.bundle, held_out);
  outcome.left_out = without_repetition(std::move(left_out));
  name_left_out(outcome);
  judge(outcome);
  if (auto sound = check_after(outcome); !sound) return std::unexpected(sound.error());
  return outcome;
}

}  // namespace beltpick::calibrate
