// Trials: puts hypotheses to the test a few at a time, and what is good enough into the pool. The pool is complete when
// the Trials is gone, no sooner.
#pragma once

#include <array>
#include <span>

#include "contract/part_model.hpp"
#include "search/hypothesis_pool.hpp"
#include "search/quality.hpp"

namespace beltpick::search {

// What every way of searching needs.
struct SearchInput {
  const PartModel& model;
  SearchSample sample;  // of the object, about 100 points
  float cap_mm;         // of the distances in Q
};

class Trials {
 public:
  Trials(const SearchInput& input, HypothesisPool& pool) : input_(input), pool_(pool) {}
  Trials(const Trials&) = delete;
  Trials& operator=(const Trials&) = delete;
  ~Trials() { run(); }  // what is left

  void add(const PartPose& T_camera_part);

 private:
  static constexpr std::size_t kTogether = 8;

  void run();

  const SearchInput& input_;
  HypothesisPool& pool_;
  std::array<PartPose, kTogether> poses_;
  std::array<QualityQuery, kTogether> queries_;
  std::size_t count_ = 0;
};

}  // namespace beltpick::search
