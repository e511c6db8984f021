#include "pipeline/pipeline.hpp"

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::pipeline {

Pipeline::Pipeline(Arena& arena, const Limits& limits, int workers)
    : limits_(limits),
      store_(arena, limits),
      segmenter_(arena, limits),
      light_finder_(arena, limits),
      locator_(arena, limits, workers) {}

Result<void> Pipeline::load(std::span<const PartTemplate> templates, const GripperShape& gripper) {
  return store_.load(templates, gripper);
}

Result<Located> Pipeline::locate(const View& view) {
  const auto& points = view.range.point_mm;
  if (store_.models().empty()) return failure(ResultCode::kNoTemplate, "no template is loaded; teach a part");
  if (points.cols > limits_.image_width || points.rows > limits_.image_height) {
    return failure(ResultCode::kLimitExceeded, "expected an image of at most %dx%d, found %dx%d; raise the limits",
                   limits_.image_width, limits_.image_height, points.cols, points.rows);
  }
  Located located;
  const Stopwatch segmenting;
  located.objects = segmenter_.segment(view.range);
  located.segment_ms = segmenting.elapsed_ms();
  const Stopwatch locating;
  const auto light_mm =
      view.projector_mm ? view.projector_mm : light_finder_.find(view.range, view.lens, located.objects.belt);
  located.found = locator_.locate({view.range, located.objects.labels, located.objects.segments, located.objects.belt,
                                   view.lens, view.seed, light_mm},
                                  store_.models());
  located.locate_ms = locating.elapsed_ms();
  return located;
}

}  // namespace beltpick::pipeline
