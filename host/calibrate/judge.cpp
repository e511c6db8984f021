#include "calibrate/judge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "calibrate/first_guess.hpp"
#include "calibrate/sift.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::calibrate {
namespace {

// Ranges of tilt and depth below which a lens is not, or not well, determined.
constexpr double kLeastTilt_deg = 8.0, kGoodTilt_deg = 25.0;
constexpr double kGoodDepthShare = 0.06;  // far - near, of the mean distance
constexpr double kGoodCoverage = 0.75;    // of the fields of the camera's image
constexpr double kLeastCoverage = 0.25;
// Of the distance. 1e-4 is 0.07 mm at 700 mm.
constexpr double kGoodHeldOut = 1e-4, kUsableHeldOut = 5e-4, kWorstHeldOut = 5e-3;
constexpr double kGoodSigma = 5e-5, kUsableSigma = 3e-4, kWorstSigma = 2e-3;

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  char line[400];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

double distance_of(const Outcome& outcome) { return 0.5 * (outcome.coverage.near_mm + outcome.coverage.far_mm); }

// The ninths of the image in which no corner lies, in words.
std::vector<std::string> empty_ninths(const CoverageGrid& grid) {
  constexpr const char* kRows[] = {"upper", "middle", "lower"};
  constexpr const char* kColumns[] = {"left", "middle", "right"};
  std::vector<std::string> names;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      int filled = 0, fields = 0;
      for (int r = row * grid.rows / 3; r < (row + 1) * grid.rows / 3; ++r) {
        for (int c = column * grid.columns / 3; c < (column + 1) * grid.columns / 3; ++c) {
          ++fields;
          filled += grid.counts[static_cast<std::size_t>(r * grid.columns + c)] > 0 ? 1 : 0;
        }
      }
      if (4 * filled >= fields) continue;
      names.push_back(row == 1 && column == 1 ? "the middle"
                                              : std::string("the ") + kRows[row] + " " + kColumns[column]);
    }
  }
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    all += i == 0 ? "" : (i + 1 == names.size() ? " and " : ", ");
    all += names[i];
  }
  return all;
}

std::string tilt_advice(double about_x_deg, double about_y_deg, double enough_deg) {
  const bool x = about_x_deg < enough_deg, y = about_y_deg < enough_deg;
  if (x && y) return "tilt the plate by 20 to 40 degrees about both axes, each way";
  if (x) return "tilt the plate more about the image's x axis (upper edge towards the camera, then away)";
  return "tilt the plate more about the image's y axis (left edge towards the camera, then away)";
}

// What to capture next; empty where nothing lacks.
std::vector<std::string> advice(const Outcome& outcome) {
  const Coverage& coverage = outcome.coverage;
  std::vector<std::string> next;
  if (std::min(coverage.tilt_x_range_deg, coverage.tilt_y_range_deg) < kGoodTilt_deg) {
    next.push_back(text("Little tilt: the plates span %.0f degrees about x and %.0f about y; %s.",
                        coverage.tilt_x_range_deg, coverage.tilt_y_range_deg,
                        tilt_advice(coverage.tilt_x_range_deg, coverage.tilt_y_range_deg, kGoodTilt_deg).c_str()));
  }
  if (coverage.far_mm - coverage.near_mm < kGoodDepthShare * distance_of(outcome)) {
    next.push_back(
        text("Little depth: all corners lie %.0f to %.0f mm from the camera; hold the plate nearer and farther too.",
             coverage.near_mm, coverage.far_mm));
  }
  const auto empty = empty_ninths(coverage.camera);
  if (!empty.empty()) {
    next.push_back(text("%.0f %% of the view is covered: %s of the image is empty; hold the plate there.",
                        100.0 * coverage.camera.share(), joined(empty).c_str()));
  } else if (coverage.camera.share() < kGoodCoverage) {
    next.push_back(text("%.0f %% of the view is covered; hold the plate nearer to the image's edges too.",
                        100.0 * coverage.camera.share()));
  }
  if (outcome.poses_used < kRecommendedPoses) {
    next.push_back(text("%d poses were used; %d to 15 are recommended.", outcome.poses_used, kRecommendedPoses));
  }
  return next;
}

std::string headline(const Outcome& outcome) {
  const char* words = outcome.grade == Grade::kGood     ? "Good"
                      : outcome.grade == Grade::kUsable ? "Usable, with reservations"
                                                        : "Poor: do not measure with it";
  return text(
      "%s: plates not used for it are measured to %.3f mm rms (largest %.3f mm) at %.0f mm, their size to %.0f ppm; "
      "points are "
      "determined to %.3f mm rms.",
      words, outcome.held_out_rms_mm, outcome.held_out_max_mm, distance_of(outcome), outcome.held_out_size_ppm,
      outcome.point_sigma_mm);
}

}  // namespace

Result<void> check_before(const Observations& seen, const Selection& use, const std::vector<LeftOut>& left_out) {
  const int poses = count_poses(use);
  if (poses < kLeastPoses) {
    const auto first =
        std::find_if(left_out.begin(), left_out.end(), [](const LeftOut& item) { return item.corner < 0; });
    const std::string why = first == left_out.end() ? "" : " (" + first->capture + ": " + first->reason + ")";
    return failure(ResultCode::kTooFewPoints,
                   "%d of %zu captures can be used, expected at least %d, better %d to 15%.200s; capture more poses",
                   poses, seen.poses.size() + seen.left_out.size(), kLeastPoses, kRecommendedPoses, why.c_str());
  }
  const RoughTilts tilts = rough_tilts(seen, use);
  if (std::max(tilts.about_x_deg, tilts.about_y_deg) < kLeastTilt_deg) {
    return failure(
        ResultCode::kCheckFailed,
        "the plates are as good as parallel (about %.0f degrees between them about x, %.0f about y): no lens "
        "follows from that; %s",
        tilts.about_x_deg, tilts.about_y_deg, tilt_advice(0.0, 0.0, 1.0).c_str());
  }
  return {};
}

void judge(Outcome& outcome) {
  const double distance_mm = distance_of(outcome);
  const double held_out = outcome.held_out_rms_mm / distance_mm;
  const double sigma = outcome.point_sigma_mm / distance_mm;
  std::vector<std::string> next = advice(outcome);
  if (held_out > kUsableHeldOut || sigma > kUsableSigma) {
    outcome.grade = Grade::kPoor;
  } else if (held_out > kGoodHeldOut || sigma > kGoodSigma || !next.empty()) {
    outcome.grade = Grade::kUsable;
  } else {
    outcome.grade = Grade::kGood;
  }
  outcome.verdict = {headline(outcome)};
  const auto poses_out = std::count_if(outcome.left_out.begin(), outcome.left_out.end(),
                                       [](const LeftOut& item) { return item.corner < 0; });
  if (poses_out > 0)
    outcome.verdict.push_back(
        text("%d captures were left out; their reasons are listed.", static_cast<int>(poses_out)));
  outcome.verdict.insert(outcome.verdict.end(), next.begin(), next.end());
}

Result<void> check_after(const Outcome& outcome) {
  const double distance_mm = distance_of(outcome);
  const auto next = advice(outcome);
  const char* remedy = next.empty() ? "look at the plate, the focus and the captures' poses" : next.front().c_str();
  if (outcome.coverage.camera.share() < kLeastCoverage) {
    return failure(ResultCode::kCheckFailed, "the plates cover %.0f %% of the view, expected at least %.0f %%; %.200s",
                   100.0 * outcome.coverage.camera.share(), 100.0 * kLeastCoverage, remedy);
  }
  if (!(outcome.point_sigma_mm < kWorstSigma * distance_mm)) {
    return failure(ResultCode::kCheckFailed, "the captures determine points only to %.2f mm at %.0f mm; %.200s",
                   outcome.point_sigma_mm, distance_mm, remedy);
  }
  if (!(outcome.held_out_rms_mm < kWorstHeldOut * distance_mm)) {
    return failure(
        ResultCode::kCheckFailed,
        "plates not used for it are measured %.2f mm wrong at %.0f mm: the calibration does not hold; %.200s",
        outcome.held_out_rms_mm, distance_mm, remedy);
  }
  return {};
}

}  // namespace beltpick::calibrate
