// One object of a scene whose part is known, and what each way of making hypotheses makes of it. All ways end in the
// same pool, are aligned the same way, and are judged by the truth.
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "bench/pose/descriptors/spin_images.hpp"
#include "bench/pose/judge.hpp"
#include "primitives/msac.hpp"

namespace beltpick::bench {

enum class Way : std::uint8_t {
  kPrimitives,  // the product's first route: cylinders and spheres found, the freedoms they leave searched
  kViews,       // its second: every view of the part
  kPlanes,      // its third: the freedoms that one face leaves
  kSpin,        // spin images
  kPresent,     // the product's three routes, the next where one finds nothing right
  kSpinFirst,   // spin images before those
  kSpinLast     // spin images after those
};
inline constexpr std::array<std::string_view, 7> kWayNames{"primitives",
                                                           "views",
                                                           "one face",
                                                           "spin images",
                                                           "primitives, views, face in turn (product)",
                                                           "spin images, then the product's",
                                                           "the product's, then spin images"};

struct Outcome {
  bool right = false;  // a right pose is among those aligned fully
  double ms = 0.0;     // hypotheses and their alignment
};

// An object under trial.
struct TrialObject {
  std::vector<OrientedPoint> sample;
  const PartModel* model = nullptr;
  result::PartPose truth;
  double noise_mm = 0.05;
};

class Trial {
 public:
  explicit Trial(const Limits& limits);

  // By way. `spin`: of the object's part.
  std::array<Outcome, kWayNames.size()> run(const TrialObject& object, const result::Scene& scene,
                                            const SpinModel& spin);

 private:
  Outcome attempt(const TrialObject& object, const result::Scene& scene, const SpinModel& spin, Way way);
  bool any_right(const TrialObject& object, const result::Scene& scene, search::HypothesisPool& pool,
                 std::size_t shortlist, std::size_t full) const;
  void search_primitives(const TrialObject& object, const search::SearchInput& input, bool faces,
                         search::HypothesisPool& pool);

  ArenaBlock block_;
  Arena arena_;
  primitives::Finder finder_;
  std::vector<Hypothesis> storage_;
};

}  // namespace beltpick::bench
