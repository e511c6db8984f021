// Story: every step that the search for a pose took, kept for the explanation.
#pragma once

#include <string>
#include <vector>

#include "pipeline/trace.hpp"

namespace beltpick::explain {

// A surface point in sight of a pose on trial, and what it met in the range image.
struct Looked {
  int row = 0, col = 0;
  result::Finding finding = result::Finding::kMissing;
};

struct FoundPrimitive {
  int model_index = 0;
  Primitive primitive;
};

struct RivalStory {
  pipeline::Candidate rival;
  result::Rivalry rivalry;
};

// A pose on trial.
struct Judged {
  pipeline::Candidate champion;
  Error verdict;  // kOk: verified
  std::vector<RivalStory> rivals;
  std::vector<Looked> looked;

  [[nodiscard]] bool verified() const { return verdict.code == ResultCode::kOk; }
};

// One route tried on one object.
struct SearchStory {
  pipeline::Object object;
  pipeline::Effort route = pipeline::Effort::kPrimitives;
  std::vector<OrientedPoint> sample;
  std::vector<FoundPrimitive> primitives;
  std::vector<pipeline::Candidate> coarse;   // in the order of Q, the best first
  std::vector<pipeline::Candidate> weighed;  // in the order of the first impression
  std::vector<Judged> judged;                // in the order of strength
  pipeline::Attempt attempt;                 // what came of it
};

const char* route_name(pipeline::Effort route);

}  // namespace beltpick::explain
