#include "scans/stitch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "scans/adjust.hpp"
#include "scans/join.hpp"
#include "scans/merge.hpp"
#include "scans/part_frame.hpp"

namespace beltpick::scans {
namespace {

// A scan may lie off the others by this multiple of its noise, and by what lenses and edges leave.
constexpr double kResidualNoises = 4.0;
constexpr double kResidualFloor_mm = 0.15;
constexpr double kMissingShare = 0.08;

template <class... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 400> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

std::vector<Tie> adjust_all(const std::vector<ScanView>& views, std::vector<ScanPose>& poses) {
  std::vector<const ScanView*> pointers;
  double noise_mm = 0.0;
  for (const ScanView& view : views) {
    pointers.push_back(&view);
    noise_mm = std::max(noise_mm, view.noise_mm);
  }
  const double last_mm = 0.5 + 6.0 * noise_mm;
  const std::array<AdjustStage, 3> stages{AdjustStage{2.0 * last_mm, 15, 1500}, AdjustStage{last_mm, 15, 4000},
                                          AdjustStage{last_mm, 6, 12000}};
  return adjust(pointers, poses, stages);
}

void report_residuals(const std::vector<Tie>& ties, Stitched& stitched) {
  std::vector<double> pairs(stitched.scans.size(), 0.0);
  double all_pairs = 0.0;
  double all_squares = 0.0;
  for (const Tie& tie : ties) {
    const double square = tie.pairs * tie.rms_mm * tie.rms_mm;
    for (const std::size_t scan : {tie.first, tie.second}) {
      pairs[scan] += tie.pairs;
      stitched.scans[scan].residual_mm += square;
    }
    all_pairs += tie.pairs;
    all_squares += square;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i)
    stitched.scans[i].residual_mm = std::sqrt(stitched.scans[i].residual_mm / std::max(1.0, pairs[i]));
  stitched.residual_mm = std::sqrt(all_squares / std::max(1.0, all_pairs));
}

void report_shared(const std::vector<ScanView>& views, const std::vector<ScanPose>& poses, Stitched& stitched) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = 0; j < views.size(); ++j) {
      if (i == j) continue;
      AgreementLimits limits = strict_limits(views[i], views[j]);
      limits.points = 3000;
      const Agreement found = look_up(views[i], views[j], poses[j].inverse() * poses[i], limits);
      stitched.scans[i].shared = std::max(stitched.scans[i].shared, found.agreeing);
    }
  }
}

Result<void> check_residuals(const Stitched& stitched) {
  const auto worst = std::max_element(stitched.scans.begin(), stitched.scans.end(),
                                      [](const auto& a, const auto& b) { return a.residual_mm < b.residual_mm; });
  const double limit_mm = kResidualFloor_mm + kResidualNoises * worst->noise_mm;
  if (worst->residual_mm <= limit_mm) return {};
  return failure(ResultCode::kResidualTooHigh,
                 "%s: lies %.2f mm (rms) off the other scans, at most %.2f mm expected of its noise of %.2f mm; is it "
                 "the same part, unbent, and the calibration still good?",
                 worst->name.c_str(), worst->residual_mm, limit_mm, worst->noise_mm);
}

void warn_of(const std::vector<SecondPlace>& seconds, const std::vector<ScanView>& views, Stitched& stitched) {
  for (const SecondPlace& second : seconds) {
    stitched.warnings.push_back(
        text("%s: fits almost as well turned by %.0f degrees and moved by %.1f mm, though the part differs there: the "
             "template "
             "may be wrong; add a scan that shows this side together with one that other scans show",
             views[second.scan].name.c_str(), deg_from_rad(second.turned_rad), second.shifted_mm));
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].cut) {
      stitched.warnings.push_back(
          text("%s: the part is cut by the image border: only what is in view counts", views[i].name.c_str()));
    }
  }
}

void warn_of_missing(Stitched& stitched) {
  // One line for the worst side; a side beside it is mostly the same gap.
  std::vector<Vec3> told;
  for (const Side& side : stitched.missing) {
    if (std::any_of(told.begin(), told.end(), [&](const Vec3& other) { return other.dot(side.towards) > 0.3; }))
      continue;
    told.push_back(side.towards);
    stitched.warnings.push_back(
        text("seen from %s of the part as it lies in the first scan, %.0f %% of the surface is in no scan: poses that "
             "show this side will be withheld; add a scan of it",
             side.name.c_str(), 100 * side.missing_share));
  }
}

void move(Mesh& surface, const Pose<frame::Part, frame::Part>& motion) {
  for (Vec3f& p : surface.vertex_mm) p = (motion * p.cast<double>()).cast<float>();
  for (Vec3f& n : surface.vertex_normal) n = (motion.rotation * n.cast<double>()).cast<float>();
}

}  // namespace

Result<Stitched> stitch(const std::vector<ScanView>& views, const std::function<void(int, int)>& done) {
  if (views.empty() || views.size() > kMostScans) {
    return failure(ResultCode::kUsage, "expected 1 to %zu scans, found %zu; give fewer", kMostScans, views.size());
  }
  auto joined = join(views, done);
  if (!joined) return std::unexpected(joined.error());
  std::vector<ScanPose>& poses = joined->T_part_scan;
  const std::vector<Tie> ties = adjust_all(views, poses);
  Stitched stitched;
  for (const ScanView& view : views)
    stitched.scans.push_back({.name = view.name, .points = view.point.size(), .noise_mm = view.noise_mm});
  report_residuals(ties, stitched);
  if (auto checked = check_residuals(stitched); !checked) return std::unexpected(checked.error());
  report_shared(views, poses, stitched);
  Merged merged = merge(views, poses);
  const auto motion = part_frame(merged.surface, views.front());
  move(merged.surface, motion);
  stitched.surface = std::move(merged.surface);
  stitched.dropped = merged.dropped;
  double spacing_mm = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    stitched.scans[i].alone = merged.added[i];
    stitched.scans[i].T_part_scan = motion * poses[i];
    spacing_mm = std::max(spacing_mm, views[i].spacing_mm);
  }
  stitched.missing = find_missing(stitched.surface, spacing_mm);
  std::erase_if(stitched.missing, [](const Side& side) { return side.missing_share < kMissingShare; });
  warn_of(joined->seconds, views, stitched);
  warn_of_missing(stitched);
  return stitched;
}

}  // namespace beltpick::scans
