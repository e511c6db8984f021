// A projector that holds the images itself and advances on an edge: beltpick's part is the edge alone.
#pragma once

#include "contract/result_codes.hpp"
#include "projector/projector.hpp"

namespace beltpick::projector {

class EdgeProjector : public Projector {
 public:
  Result<void> prepare(const ShowPlan&) override { return {}; }
  Result<void> start() override { return {}; }
  Result<void> stop() override { return {}; }
  Result<void> check() override { return {}; }
  void close() override {}
  [[nodiscard]] ProjectorFacts facts() const override { return {"any that advances on an edge", "", "", ""}; }
  Result<std::int64_t> show(int) override {
    return failure(ResultCode::kInternal,
                   "projector: expected one that is led by the PC, found one that an edge leads");
  }
};

}  // namespace beltpick::projector
