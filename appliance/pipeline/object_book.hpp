// ObjectBook: which pixels no part explains yet, what is therefore to be searched next, and what came of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "contract/limits.hpp"
#include "contract/locate_result.hpp"
#include "pipeline/attempt.hpp"
#include "pipeline/object_points.hpp"
#include "result/scene.hpp"

namespace beltpick::pipeline {

class ObjectBook {
 public:
  ObjectBook(Arena& arena, const Limits& limits);

  // A new image: every labelled pixel is unexplained. `smallest_view_mm2`: the least surface that a whole part shows.
  void begin(const result::Scene& scene, std::span<const Segment> segments, double smallest_view_mm2);

  // What to search next, all with the effort that `effort()` then tells. What is found cheaply takes its surface away
  // from the rest: first whole objects, then fragments, both with growing effort; then failed ones together with failed
  // neighbours at most `reach_mm` away. What a found part left of an object is new again. Empty when nothing is new.
  std::span<const Object> next_round(const result::Scene& scene, double reach_mm);
  [[nodiscard]] Effort effort() const { return effort_; }

  // Takes away the pixels that lie on the part within the tolerance.
  void explain(const result::Scene& scene, const PartModel& model, const result::PartPose& T_camera_part,
               const result::Region& region);

  // Keeps the attempt that came nearest to a pose, for each segment of an object that was searched in vain.
  void failed(const Object& object, const Attempt& attempt);
  // Searches again what a pose was found of that `believes(attempt)` would now believe, having learnt more of the
  // scene.
  template <class Believes>
  void reconsider(const Believes& believes) {
    for (Entry& e : entries_.first(entry_count_)) {
      if (e.segment.pixels == 0 || !e.nearest.failed() || e.nearest.stage != Stage::kVerify) continue;
      if (believes(e.nearest)) e.pixels_when_new = -1;
    }
  }
  // That attempt, if no more will be tried with the object as it is; or null.
  [[nodiscard]] const Attempt* last_word(const Object& object) const;

  // Whether `doubts(attempt)` is true of an ambiguous attempt at any segment.
  template <class Doubts>
  [[nodiscard]] bool any_ambiguous(const Doubts& doubts) const {
    const auto entries = entries_.first(entry_count_);
    return std::any_of(entries.begin(), entries.end(),
                       [&](const Entry& e) { return e.nearest.ambiguous() && doubts(e.nearest); });
  }

  // Writes what remains unexplained, with its reason; returns how many.
  std::size_t withheld(std::span<WithheldObject> out) const;

  [[nodiscard]] ImageView<const std::uint16_t> owner() const { return owner_; }

 private:
  struct Entry {
    Segment segment;  // what is left of it
    int pixels_at_start = 0;
    int pixels_when_new = -1;
    double area_mm2 = 0.0;
    Effort next = Effort::kPrimitives;
    bool given_up = false;
    bool claimed = false;                 // an ambiguous pose explains what has been taken away
    Object pieces;                        // what was last searched round it, itself and those next to it
    Effort joined = Effort::kPrimitives;  // the last such search for what had failed
    Attempt nearest;
  };

  void recount(const result::Scene& scene);
  void renew(Entry& entry) const;
  [[nodiscard]] static bool came_near(const Entry& entry);
  [[nodiscard]] int turn(const Entry& entry) const;
  void join_failed(double reach_mm);
  template <class Belongs>
  void add_joined(Entry& seed, double reach_mm, const Belongs& belongs);
  [[nodiscard]] bool searched_already(const Object& object) const;
  Entry* entry(std::uint16_t label);
  [[nodiscard]] const Entry* entry(std::uint16_t label) const;

  ImageView<std::uint16_t> owner_;
  std::span<Entry> entries_;
  std::size_t entry_count_ = 0;
  std::span<std::uint16_t> entry_of_label_;
  std::span<Object> objects_;
  std::size_t object_count_ = 0;
  double smallest_view_mm2_ = 0.0;
  bool recount_due_ = true;  // pixels were taken away since the last one
  Effort effort_ = Effort::kPrimitives;
};

}  // namespace beltpick::pipeline
