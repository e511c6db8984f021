// Chapters: the explanation sorted by segment: what became of each, and the searches that led to it.
#pragma once

#include <string>
#include <vector>

#include "explain/q_map.hpp"
#include "pipeline/pipeline.hpp"

namespace beltpick::explain {

enum class Fate { kLocated, kWithheld, kTakenIn };

struct Chapter {
  Segment segment;
  Fate fate = Fate::kTakenIn;
  std::vector<int> parts;                    // indices into the located parts that were found by this segment
  const WithheldObject* withheld = nullptr;  // where it was
  std::vector<const SearchStory*> searches;  // all that looked at it, in order
  const SearchStory* decisive = nullptr;     // the one that the verdict comes from; null: none was made
  const Judged* judged = nullptr;            // the pose of it that was judged last
};

std::vector<Chapter> chapters_of(const pipeline::Located& located, const std::vector<SearchStory>& searches);

// One sentence: what became of the segment.
std::string fate_of(const Chapter& chapter, const pipeline::Located& located, std::span<const PartTemplate> templates);

// What could be done about it; empty where nothing need be.
std::string advice_of(const Chapter& chapter, const pipeline::Located& located);

}  // namespace beltpick::explain
