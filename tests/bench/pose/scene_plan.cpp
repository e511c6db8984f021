#include "bench/pose/scene_plan.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/random.hpp"

namespace beltpick::bench {
namespace {

using virtual_cell::Lay;

// Settling takes seconds a part: only parts that are rendered frame by frame do.
Lay lay_of(const ScenePlan& plan, int number, Random& random) {
  const double draw = random.uniform();
  const Lay on_others = plan.rendered ? Lay::kLeaning : Lay::kDropped;
  if (plan.kind == SceneKind::kHeap) return number == 0 ? Lay::kFlat : draw < 0.8 ? on_others : Lay::kAny;
  if (plan.kind != SceneKind::kApart && number > 0 && draw < 0.45) return on_others;
  if (draw < 0.75) return Lay::kAny;
  return draw < 0.88 ? Lay::kEdge : Lay::kCut;
}

template <class T>
T drawn(const std::vector<T>& from, Random& random) {
  return from[random.below(static_cast<std::uint32_t>(from.size()))];
}

// The parts of a scene, in the order in which they are laid.
std::vector<int> choose_parts(const PartPool& pool, const ScenePlan& plan, int asked, Random& random) {
  int count = (plan.kind == SceneKind::kApart ? 3
               : plan.rendered                ? 4
                                              : 5) +
              static_cast<int>(random.below(plan.rendered ? 2 : 3));
  if (asked > 0) count = asked;
  std::vector<int> chosen;
  for (int i = 0; i < count; ++i) {
    int part = drawn(plan.kind == SceneKind::kMixed ? plan.loaded : std::vector<int>{plan.loaded.front()}, random);
    const bool other = random.uniform() < 0.45;
    if (plan.kind == SceneKind::kForeign && other) part = drawn(pool.foreign, random);
    if (plan.kind == SceneKind::kTwins && other) part = pool.twin_of[static_cast<std::size_t>(part)];
    chosen.push_back(part);
  }
  return chosen;
}

SceneKind drawn_kind(const std::vector<SceneKind>& kinds, Random& random) {
  if (!kinds.empty()) return drawn(kinds, random);
  const double draw = random.uniform();
  return draw < 0.25   ? SceneKind::kApart
         : draw < 0.50 ? SceneKind::kHeap
         : draw < 0.65 ? SceneKind::kMixed
         : draw < 0.80 ? SceneKind::kForeign
                       : SceneKind::kTwins;
}

}  // namespace

SceneKind scene_kind(std::string_view name) {
  const auto at = std::find(kSceneKindNames.begin(), kSceneKindNames.end(), name);
  if (at == kSceneKindNames.end())
    throw std::runtime_error("--kinds: expected apart, heap, mixed, foreign or twins, found '" + std::string(name) +
                             "'");
  return static_cast<SceneKind>(at - kSceneKindNames.begin());
}

ScenePlan plan_scene(const PartPool& pool, const PlanOptions& options, int k) {
  Random alike(options.seed, 7000 + static_cast<std::uint64_t>(k / kScenesAlike));
  ScenePlan plan;
  plan.rendered = options.rendered_every > 0 && k / kScenesAlike % options.rendered_every == 0;
  plan.kind = drawn_kind(options.kinds, alike);
  std::vector<int> families = pool.families;
  if (plan.kind == SceneKind::kTwins)
    std::erase_if(families, [&](int f) { return pool.twin_of[static_cast<std::size_t>(f)] < 0; });
  plan.loaded = {drawn(families, alike)};
  if (plan.kind == SceneKind::kTwins && alike.uniform() < 0.5)
    plan.loaded.push_back(pool.twin_of[static_cast<std::size_t>(plan.loaded.front())]);
  while (plan.kind == SceneKind::kMixed && plan.loaded.size() < std::min<std::size_t>(3, families.size())) {
    const int more = drawn(families, alike);
    if (std::find(plan.loaded.begin(), plan.loaded.end(), more) == plan.loaded.end()) plan.loaded.push_back(more);
  }
  plan.scene_seed = options.seed * 1'000'003U + static_cast<std::uint64_t>(k);
  Random random(plan.scene_seed, 11);
  const std::vector<int> parts = choose_parts(pool, plan, options.parts, random);
  for (std::size_t i = 0; i < parts.size(); ++i)
    plan.lays.push_back({lay_of(plan, static_cast<int>(i), random), parts[i]});
  return plan;
}

}  // namespace beltpick::bench
