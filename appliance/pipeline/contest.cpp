#include "pipeline/contest.hpp"

#include "pipeline/pose_hold.hpp"

namespace beltpick::pipeline {

result::Rivalry contend(const Candidate& a, const Candidate& b, const result::Scene& scene,
                        std::span<const PartModel> models) {
  constexpr int kStep = 4;
  const auto claim = [&](const Candidate& candidate) {
    return result::Rival{models[static_cast<std::size_t>(candidate.model_index)], candidate.alignment.T_camera_part};
  };
  return result::compare(claim(a), claim(b), scene, kStep);
}

bool stands(const Candidate& champion, const Candidate& rival, const result::Rivalry& rivalry) {
  return rival.evidence.blemishes.any() ? !result::prevails(result::reversed(rivalry), rival.evidence.support)
                                        : result::prevails(rivalry, champion.evidence.support);
}

bool doubted(const Candidate& candidate, const Attempt& ambiguous, const result::Scene& scene,
             std::span<const PartModel> models) {
  const PartModel& model = models[static_cast<std::size_t>(candidate.model_index)];
  if (same_place(candidate, ambiguous.best, model)) return determined(ambiguous.best.alignment, model);
  const result::Rivalry rivalry = contend(candidate, ambiguous.best, scene, models);
  return rivalry.same_object() && !result::prevails(rivalry, candidate.evidence.support);
}

}  // namespace beltpick::pipeline
