// Two poses that both fit: which one does the picture want? Only places where they disagree can tell.
#pragma once

#include "contract/part_model.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

// Two poses, and what each of two parts explains of the measured points near both.
struct Rivalry {
  int both = 0;  // pixels that lie on either
  int only_first = 0;
  int only_second = 0;

  // Whether they claim the same object: most of what the lesser one explains.
  [[nodiscard]] bool same_object() const {
    const int lesser = both + (only_first < only_second ? only_first : only_second);
    return 10 * both > 3 * lesser;
  }
};

// One side of a rivalry.
struct Rival {
  const PartModel& model;
  PartPose T_camera_part;
};

// Counts, over the measured pixels of objects (on every `step`-th row and column of the image), what lies on the
// surface of either. The tolerance is that of each model's spacing.
Rivalry compare(const Rival& first, const Rival& second, const Scene& scene, int step);

// The same from the second's side.
constexpr Rivalry reversed(const Rivalry& r) { return {r.both, r.only_second, r.only_first}; }

// Whether the first pose, of which `support` is measured, is to be believed against the second: enough places speak for
// it, and few against.
bool prevails(const Rivalry& rivalry, double support);

}  // namespace beltpick::result
