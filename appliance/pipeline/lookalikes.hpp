// Lookalikes: other poses that put nearly the same surface where an object is: the part turned about an axis of its
// own, its mirror image, or another part laid into its box. A search that found one of them need not have met the
// others.
#pragma once

#include "contract/part_model.hpp"
#include "result/scene.hpp"
#include "search/hypothesis_pool.hpp"
#include "search/quality.hpp"

namespace beltpick::pipeline {

// Offers those turns of the part about its box's axes and its primitives' that still explain the sample (camera frame).
void offer_turns(const PartModel& model, const result::PartPose& T_camera_part, const search::SearchSample& sample,
                 search::HypothesisPool& pool);

// Offers those of the 24 ways to lay the other part into the part's box that still explain the sample.
void offer_other(const PartModel& model, const result::PartPose& T_camera_part, const PartModel& other,
                 const search::SearchSample& sample, search::HypothesisPool& pool);

// Offers those mirror images of the part, about planes of its box and its bores and between any two of its faces,
// that still explain the sample. Their rotations have determinant -1: no motion brings the part there, but its mirror
// twin, whose template need not be loaded, may lie so.
void offer_mirrored(const PartModel& model, const result::PartPose& T_camera_part, const search::SearchSample& sample,
                    search::HypothesisPool& pool);

}  // namespace beltpick::pipeline
