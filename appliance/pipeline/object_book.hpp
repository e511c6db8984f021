// ObjectBook: which pixels no part explains yet, what is therefore to be searched next, and what came of it.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "contract/limits.hpp"
#include "contract/locate_result.hpp"
#include "pipeline/object_points.hpp"
#include "result/scene.hpp"

namespace beltpick::pipeline {

class ObjectBook {
 public:
  ObjectBook(Arena& arena, const Limits& limits);

  // A new image: every labelled pixel is unexplained. Objects with a smaller surface than `least_area_mm2` are not
  // searched by themselves.
  void begin(const result::Scene& scene, std::span<const Segment> segments, double least_area_mm2);

  // The objects to search next: in the first round each segment by itself; later what a found part left of a segment,
  // and failed segments together with failed neighbours at most `reach_mm` away. Empty when there is nothing new.
  std::span<const Object> next_round(const result::Scene& scene, double reach_mm);

  // Takes away the pixels that lie on the part within the tolerance.
  void explain(const result::Scene& scene, const PartModel& model, const result::PartPose& T_camera_part,
               const result::Region& region);

  // Keeps why the search of an object ended without a pose, for each of its segments.
  void failed(const Object& object, Stage stage, const Error& reason);

  // Writes what remains unexplained, with its reason; returns how many.
  std::size_t withheld(std::span<WithheldObject> out) const;

  [[nodiscard]] ImageView<const std::uint16_t> owner() const { return owner_; }

 private:
  struct Entry {
    Segment segment;  // what is left of it
    int pixels_at_start = 0;
    int pixels_when_tried = -1;
    double area_mm2 = 0.0;
    bool failed = false;
    bool joined = false;  // was searched with its neighbours
    Stage stage = Stage::kSegment;
    Error reason;
  };

  void recount(const result::Scene& scene);
  void join_neighbours(double reach_mm);
  Entry* entry(std::uint16_t label);

  ImageView<std::uint16_t> owner_;
  std::span<Entry> entries_;
  std::size_t entry_count_ = 0;
  std::span<std::uint16_t> entry_of_label_;
  std::span<Object> objects_;
  std::size_t object_count_ = 0;
  double least_area_mm2_ = 0.0;
  int round_ = 0;
};

}  // namespace beltpick::pipeline
