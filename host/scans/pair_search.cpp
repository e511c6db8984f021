#include "scans/pair_search.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "scans/adjust.hpp"

namespace beltpick::scans {
namespace {

constexpr std::size_t kVoted = 500;
constexpr std::size_t kPulled = 220;  // of the voted ones: pulled towards each other by few points
constexpr std::size_t kAligned = 50;  // of those: aligned fully
constexpr double kSameRotation = 0.04;
constexpr double kSameShare = 0.01;  // of the part's size
// A right pose overlaps by more, and hardly contradicts.
constexpr double kLeastAgreeing = 0.04;
constexpr double kMostContradicting = 0.05;

bool better(const Fit& a, const Fit& b) { return merit(a.agreement) > merit(b.agreement); }

void keep_best(std::vector<Fit>& fits, std::size_t most) {
  std::stable_sort(fits.begin(), fits.end(), better);
  if (fits.size() > most) fits.resize(most);
}

CrossPose aligned(const ScanView& model, const ScanView& scan, const CrossPose& start,
                  std::span<const AdjustStage> stages) {
  const std::array<const ScanView*, 2> views{&model, &scan};
  std::array<ScanPose, 2> poses{ScanPose{}, ScanPose{start.rotation, start.translation_mm}};
  adjust(views, poses, stages);
  return {poses[1].rotation, poses[1].translation_mm};
}

// Aligns all in `stages`, and keeps those that then fit best. Where two scans share little, the wide stages draw a good
// pose away: what the other has not seen is laid on whatever is near, and contradicts. So each is aligned from every
// stage on, and not at all, and the best of it stays.
void align_all(const ScanView& model, const ScanView& scan, std::span<const AdjustStage> stages,
               const AgreementLimits& limits, std::size_t most, std::vector<Fit>& fits) {
  for (Fit& fit : fits) {
    const CrossPose start = fit.T_model_scan;
    fit.agreement = mutual(model, scan, start, limits);
    for (std::size_t first = 0; first < stages.size(); ++first) {
      const CrossPose moved = aligned(model, scan, start, stages.subspan(first));
      const Fit found{moved, mutual(model, scan, moved, limits)};
      if (better(found, fit)) fit = found;
    }
  }
  keep_best(fits, most);
}

bool same(const Fit& a, const Fit& b, const Vec3& middle, double size_mm) {
  return rotation_between_rad(a.T_model_scan.rotation, b.T_model_scan.rotation) < kSameRotation &&
         (a.T_model_scan * middle - b.T_model_scan * middle).norm() < kSameShare * size_mm;
}

}  // namespace

AgreementLimits strict_limits(const ScanView& a, const ScanView& b) {
  const double noise_mm = std::max(a.noise_mm, b.noise_mm);
  return {.surface_mm = 0.35 + 4.0 * noise_mm, .space_mm = 1.2 + 4.0 * noise_mm, .points = 1500};
}

std::vector<Fit> search_pair(const ScanView& model, const PairTable& table, const ScanView& scan, std::size_t most) {
  const double size_mm = std::max(model.diagonal_mm, scan.diagonal_mm);
  const AgreementLimits coarse{.surface_mm = 0.02 * size_mm, .space_mm = 0.03 * size_mm, .points = 250};
  std::vector<Fit> fits;
  for (const VotedPose& voted : table.vote(scan, kVoted))
    fits.push_back({voted.T_model_scan, mutual(model, scan, voted.T_model_scan, coarse)});
  keep_best(fits, kPulled);
  const std::array<AdjustStage, 2> pull{AdjustStage{0.06 * size_mm, 4, 200}, AdjustStage{0.03 * size_mm, 4, 200}};
  const AgreementLimits medium{.surface_mm = 0.01 * size_mm, .space_mm = 0.015 * size_mm, .points = 300};
  align_all(model, scan, pull, medium, kAligned, fits);
  const std::array<AdjustStage, 3> settle{AdjustStage{0.02 * size_mm, 8, 400},
                                          AdjustStage{std::max(1.0, 0.01 * size_mm), 10, 600},
                                          AdjustStage{1.0, 10, 1200}};
  align_all(model, scan, settle, strict_limits(model, scan), kAligned, fits);
  const Vec3 middle = scan.point[0].point_mm.cast<double>();
  std::vector<Fit> distinct;
  for (const Fit& fit : fits) {
    if (fit.agreement.agreeing < kLeastAgreeing || fit.agreement.contradicting > kMostContradicting) continue;
    const auto seen = [&](const Fit& other) { return same(fit, other, middle, size_mm); };
    if (std::none_of(distinct.begin(), distinct.end(), seen)) distinct.push_back(fit);
    if (distinct.size() == most) break;
  }
  return distinct;
}

}  // namespace beltpick::scans
