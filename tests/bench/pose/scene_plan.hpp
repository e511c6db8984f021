// What lies on the belt in the bench's scene number k, and which templates are loaded there: all from seed and k.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "bench/pose/part_pool.hpp"
#include "virtual_cell/render/scene.hpp"

namespace beltpick::bench {

enum class SceneKind : std::uint8_t {
  kApart,    // parts of one family side by side, some on an edge, some cut by the image's border
  kHeap,     // parts of one family leaning on each other
  kMixed,    // three families, all of them loaded
  kForeign,  // among and under things that no template is loaded for
  kTwins     // among mirror images; the mirrored template is loaded too in half of these scenes
};
inline constexpr std::array<std::string_view, 5> kSceneKindNames{"apart", "heap", "mixed", "foreign", "twins"};

struct ScenePlan {
  SceneKind kind = SceneKind::kApart;
  std::vector<int> loaded;  // indices into the pool's templates
  std::vector<virtual_cell::PartLay> lays;
  bool rendered = false;  // frame by frame and decoded; else its codes are cast
  std::uint64_t scene_seed = 1;
};

inline constexpr int kScenesAlike = 10;  // scenes in a row with the same templates

// Which scenes there are to be.
struct PlanOptions {
  std::uint64_t seed = 1;
  int rendered_every = 10;       // lots of scenes of which one is rendered and its parts settle; 0: none
  std::vector<SceneKind> kinds;  // drawn from; empty: all, by their weight
  int parts = 0;                 // in each scene; 0: drawn
};

ScenePlan plan_scene(const PartPool& pool, const PlanOptions& options, int k);

// Throws std::runtime_error for another name.
SceneKind scene_kind(std::string_view name);

}  // namespace beltpick::bench
