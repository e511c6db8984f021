// A capture of the virtual cell in memory, with its truth, and what the decoder and the triangulator make of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/arena.hpp"
#include "contract/calibration.hpp"
#include "decode/decoder.hpp"
#include "range/triangulator.hpp"
#include "virtual_cell/render/scene.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::bench {

// Which scene is rendered and how.
struct SceneChoice {
  enum class Kind : std::uint8_t { kPlane, kBare, kParts };
  Kind kind = Kind::kParts;
  std::vector<std::string> parts{"knuckle", "elbow", "bracket"};  // names or mesh files
  int parts_in_view = 3;
  virtual_cell::RigOptions rig;
  virtual_cell::RenderOptions render;
};

// What the decoder and the triangulator say; views of VirtualCapture's memory.
struct Measurement {
  CodeImage code;
  RangeImage range;
};

class VirtualCapture {
 public:
  // Throws std::runtime_error with the reason where the choice cannot be rendered.
  explicit VirtualCapture(const SceneChoice& choice);
  ~VirtualCapture();

  // Lays the scene of `seed` and renders all frames of `sequence`.
  void expose(const Sequence& sequence, std::uint64_t seed);
  // Decodes and triangulates the frames; the views stay good until the next call.
  Measurement measure(bool correct_ripple = true);

  [[nodiscard]] const virtual_cell::SceneRenderer& truth() const { return *renderer_; }
  [[nodiscard]] const virtual_cell::Rig& rig() const { return rig_; }
  [[nodiscard]] ProjectorGrid grid() const { return {rig_.projector.width, rig_.projector.height, rig_.layout}; }

 private:
  struct Stages;

  SceneChoice choice_;
  virtual_cell::Rig rig_;
  Calibration calibration_;
  std::vector<virtual_cell::ScenePart> parts_;
  std::optional<virtual_cell::SceneMaker> maker_;
  std::unique_ptr<virtual_cell::SceneRenderer> renderer_;
  Sequence sequence_;
  std::vector<std::vector<std::uint8_t>> frames_;
  decode::FoldPlan plan_;
  std::unique_ptr<Stages> stages_;
};

}  // namespace beltpick::bench
