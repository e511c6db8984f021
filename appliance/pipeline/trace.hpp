// Trace: what the search for a pose tells, step by step, to whoever listens (`beltpick locate --explain`). On the
// appliance nobody listens: each step then costs the test of one pointer.
#pragma once

#include <span>

#include "base/result.hpp"
#include "contract/part_model.hpp"
#include "pipeline/attempt.hpp"
#include "pipeline/object_points.hpp"
#include "result/rivalry.hpp"
#include "result/scene.hpp"

namespace beltpick::pipeline {

// One route tried on one object. Views: valid during the call that hands them over.
struct TracedSearch {
  const result::Scene& scene;
  ImageView<const std::uint16_t> owner;  // to which object each pixel belongs that is not explained yet
  const Object& object;
  std::span<const PartModel> models;
  std::span<const OrientedPoint> sample;  // of the object
  Effort route;                           // kPrimitives, kPlanes or kViews
};

// All calls come from one thread: a locator with a trace has one worker. Each search begins and ends; between the two
// its steps come in the order in which they were taken.
class Trace {
 public:
  Trace() = default;
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;
  virtual ~Trace() = default;

  virtual void begins(const TracedSearch& search) = 0;
  // A primitive that was looked for because the model has it.
  virtual void primitive_found(int model_index, const Primitive& found) = 0;
  // A hypothesis, aligned coarsely; `impression` is what ranks it.
  virtual void aligned_coarsely(const Candidate& candidate) = 0;
  // One of the best of those, aligned with the whole sample and drawn; `strength` is what ranks it.
  virtual void weighed(const Candidate& candidate) = 0;
  // One of the strongest, finished, and what judgement it met.
  virtual void judged(const Candidate& champion, const Result<void>& verdict) = 0;
  // Another pose that might explain the same surface, compared with the champion.
  virtual void compared(const Candidate& champion, const Candidate& rival, const result::Rivalry& rivalry) = 0;
  virtual void ends(const Attempt& attempt) = 0;
  // A verified pose gave way to a stronger one that claims the same surface, or was taken in as a part's.
  virtual void settled(const Object& object, const Attempt& attempt) = 0;
};

}  // namespace beltpick::pipeline
