// Machine: the product's pipeline from the frames on, in memory of its own.
#pragma once

#include "base/arena.hpp"
#include "pipeline/measure.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::bench {

struct Machine {
  Limits limits;
  ArenaBlock block;
  Arena arena;
  pipeline::Measure measure;
  pipeline::Pipeline pipeline;

  explicit Machine(const Limits& declared, int workers = 1)
      : limits(declared),
        block(bytes(limits, workers)),
        arena(block.data(), block.bytes()),
        measure(arena, limits),
        pipeline(arena, limits, workers) {}

 private:
  static std::size_t bytes(const Limits& limits, int workers) {
    Arena measuring;
    const pipeline::Measure measure(measuring, limits);
    const pipeline::Pipeline pipeline(measuring, limits, workers);
    return measuring.used_bytes();
  }
};

}  // namespace beltpick::bench
