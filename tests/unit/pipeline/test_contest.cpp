// Which of two poses that claim one object is believed.
#include "pipeline/contest.hpp"

#include <catch2/catch.hpp>

using namespace beltpick;

namespace {

pipeline::Candidate seen(double support) {
  pipeline::Candidate candidate;
  candidate.evidence.support = support;
  return candidate;
}

pipeline::Candidate blemished(double support) {
  pipeline::Candidate candidate = seen(support);
  candidate.evidence.blemishes.seen_through_mm2 = 2.0;
  return candidate;
}

}  // namespace

TEST_CASE("a pose stands against a clean rival that it prevails over") {
  CHECK(pipeline::stands(seen(0.9), seen(0.9), {14000, 300, 20}));
  CHECK_FALSE(pipeline::stands(seen(0.9), seen(0.9), {14000, 20, 20}));
  CHECK_FALSE(pipeline::stands(seen(0.9), seen(0.9), {14000, 20, 300}));
}

TEST_CASE("a pose stands against a blemished rival that explains as much, not against one that explains more") {
  CHECK(pipeline::stands(seen(0.9), blemished(0.9), {14000, 300, 20}));
  CHECK(pipeline::stands(seen(0.9), blemished(0.9), {14000, 20, 20}));
  CHECK_FALSE(pipeline::stands(seen(0.9), blemished(0.9), {14000, 20, 300}));
}
