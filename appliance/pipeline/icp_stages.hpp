// How a pose of the search is aligned, from wide to narrow: the stages that PoseFinder runs, and that teaching measures
// the basin of.
#pragma once

#include <array>
#include <cstddef>

#include "contract/part_model.hpp"
#include "icp/align.hpp"

namespace beltpick::pipeline {

// Points of an object that its poses are first aligned with.
inline constexpr std::size_t kCoarseSample = 200;

// What a stage need not settle, the next one does: a step shorter than this share of its radius ends it.
inline constexpr double kEnough = 0.01;

// Distances of search and alignment grow with the part. Where distances in Q are capped, and how far the first
// alignment looks:
inline double coarse_radius_mm(const PartModel& model) { return 0.08 * model.diagonal_mm; }
inline double fine_radius_mm(const PartModel& model) { return 0.03 * model.diagonal_mm; }

// For every pose on the short list, with kCoarseSample points.
inline std::array<icp::Stage, 2> coarse_stages(const PartModel& model) {
  return {icp::Stage{coarse_radius_mm(model), 8, 0.3F, 0.3F, kEnough},
          icp::Stage{fine_radius_mm(model), 6, 0.5F, 0.3F, kEnough}};
}

// For the best of them, with the whole sample. `tolerance_mm`: of the surface, see result::surface_tolerance_mm.
inline std::array<icp::Stage, 2> full_stages(const PartModel& model, double tolerance_mm) {
  return {icp::Stage{fine_radius_mm(model), 15, 0.5F, 0.2F, kEnough},
          icp::Stage{3.0 * tolerance_mm, 15, 0.7F, 0.1F, kEnough}};
}

}  // namespace beltpick::pipeline
