#include "scans/pair_search.hpp"

#include <algorithm>
#include <array>

#include "scans/adjust.hpp"

namespace beltpick::scans {
namespace {

constexpr std::size_t kVoted = 400;
constexpr std::size_t kAligned = 60;
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

CrossPose aligned(const ScanView& model, const ScanView& scan, const CrossPose& start, double size_mm) {
  const std::array<const ScanView*, 2> views{&model, &scan};
  std::array<ScanPose, 2> poses{ScanPose{}, ScanPose{start.rotation, start.translation_mm}};
  const std::array<AdjustStage, 4> stages{AdjustStage{0.05 * size_mm, 8, 350}, AdjustStage{0.025 * size_mm, 8, 350},
                                          AdjustStage{std::max(1.0, 0.01 * size_mm), 10, 600},
                                          AdjustStage{1.0, 10, 1200}};
  adjust(views, poses, stages);
  return {poses[1].rotation, poses[1].translation_mm};
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
  keep_best(fits, kAligned);
  const AgreementLimits strict = strict_limits(model, scan);
  for (Fit& fit : fits) {
    fit.T_model_scan = aligned(model, scan, fit.T_model_scan, size_mm);
    fit.agreement = mutual(model, scan, fit.T_model_scan, strict);
  }
  std::stable_sort(fits.begin(), fits.end(), better);
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
