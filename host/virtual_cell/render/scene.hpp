// Scenes: which parts lie where on the belt. Deterministic by seed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.hpp"
#include "virtual_cell/render/belt_part.hpp"
#include "virtual_cell/render/resting.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

// How a part is laid down.
enum class Lay : std::uint8_t {
  kFlat,     // in its lowest resting poses
  kEdge,     // on a short edge: a resting pose that stands higher
  kAny,      // any resting pose, as often as it falls so
  kLeaning,  // dropped onto the part laid before it, and left to settle
  kCut,      // as kAny, but partly outside the view
  kDropped,  // let down onto the parts before it, tilted, and held where it first touches: a heap without settling
  kPropped   // in any orientation, held so by a prop that is not seen: as one turns a part to scan it from all sides
};

// A part to be laid: which of the parts, or one drawn by seed.
struct PartLay {
  static constexpr int kDrawn = -1;
  Lay lay = Lay::kAny;
  int part = kDrawn;
};

// Lays parts one after the other where there is room, leaning ones onto their predecessor.
class SceneMaker {
 public:
  // `parts` must outlive the maker. Works out the resting poses and contact fields of all parts (some 0.3 s a part).
  SceneMaker(std::span<const ScenePart> parts, const Rig& rig);
  ~SceneMaker();
  SceneMaker(const SceneMaker&) = delete;
  SceneMaker& operator=(const SceneMaker&) = delete;

  // One view: a part for each entry of `lays`; which of the parts is drawn by seed.
  [[nodiscard]] Scene make(std::span<const Lay> lays, std::uint64_t seed) const;
  // The same with parts of one's choice. Fewer come where there is no room for all.
  [[nodiscard]] Scene make(std::span<const PartLay> lays, std::uint64_t seed) const;

  // A belt of `count` parts in views of three: mostly any resting pose, some leaning, some cut by the image's border.
  [[nodiscard]] std::vector<Scene> make_belt(int count, std::uint64_t seed) const;

  // Measurement 1..12 of the paper's Figure 4: three parts each, most flat, some on short edges, some leaning on
  // neighbours, a few partly outside the image. Error: kValueOutOfRange for another number.
  [[nodiscard]] Result<Scene> make_paper_scene(int number, std::uint64_t seed) const;

  [[nodiscard]] const std::vector<RestingPose>& resting(int part) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace beltpick::virtual_cell
