// A template loaded as the pose stages use it, for tests.
#pragma once

#include <stdexcept>

#include "base/arena.hpp"
#include "pipeline/locate.hpp"
#include "pipeline/model_store.hpp"
#include "support/scenes/scenes.hpp"
#include "support/scenes/shapes.hpp"

namespace beltpick::test {

// Limits small enough for tests: a grid of about 1 mm for the test parts.
inline Limits test_limits() {
  Limits limits;
  limits.image_width = 640;
  limits.image_height = 480;
  limits.templates = 2;
  limits.template_points = 20000;
  limits.grid_cells = 1'500'000;
  return limits;
}

// Memory, taken in the two passes, and what is made in it.
template <class T>
struct InArena {
  ArenaBlock block;
  Arena arena;
  T made;

  template <class... Arguments>
  explicit InArena(const Limits& limits, Arguments... arguments)
      : block(bytes(limits, arguments...)), arena(block.data(), block.bytes()), made(arena, limits, arguments...) {}

 private:
  template <class... Arguments>
  static std::size_t bytes(const Limits& limits, Arguments... arguments) {
    Arena measuring;
    const T sizes(measuring, limits, arguments...);
    return measuring.used_bytes();
  }
};

// What the locator is given of a scene; views of `image`.
inline pipeline::LocateInput input_of(SceneImage& image) {
  pipeline::LocateInput input;
  input.range = image.range();
  input.labels = image.labels();
  input.segments = image.segments;
  input.belt = image.belt;
  input.lens = image.lens;
  return input;
}

struct LoadedPart {
  PartTemplate part;
  InArena<pipeline::ModelStore> store;

  explicit LoadedPart(const Shape& shape, const Limits& limits = test_limits())
      : part(template_of(shape)), store(limits) {
    if (!store.made.load({&part, 1})) throw std::runtime_error("test part does not load");
  }
  [[nodiscard]] const PartModel& model() const { return store.made.models().front(); }
};

}  // namespace beltpick::test
