#include "explain/chapter.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"
#include "html/page.hpp"

namespace beltpick::explain {
namespace {

using html::formatted;

std::string sentence_of(ResultCode code) {
  const ResultCodeEntry* entry = find_result_code(code);
  return entry == nullptr ? std::string() : std::string(entry->cause);
}

std::string remedy_of(ResultCode code) {
  const ResultCodeEntry* entry = find_result_code(code);
  return entry == nullptr ? std::string() : std::string(entry->remedy);
}

// The search whose verdict stands: the verified one, or the last that was withheld for the reason told.
const SearchStory* decisive_of(const Chapter& chapter) {
  const SearchStory* last = chapter.searches.empty() ? nullptr : chapter.searches.back();
  for (const SearchStory* search : chapter.searches) {
    if (chapter.fate == Fate::kLocated && search->attempt.verified && !search->attempt.failed()) last = search;
    if (chapter.withheld != nullptr && search->attempt.reason.text() == chapter.withheld->reason.text()) last = search;
  }
  return last;
}

// The verified pose, or the one whose lack is the reason told; the first where none is.
const Judged* judged_of(const SearchStory& search) {
  for (const Judged& judged : search.judged) {
    if (judged.verified() || (search.attempt.failed() && judged.verdict.text() == search.attempt.reason.text()))
      return &judged;
  }
  return search.judged.empty() ? nullptr : &search.judged.front();
}

}  // namespace

std::vector<Chapter> chapters_of(const pipeline::Located& located, const std::vector<SearchStory>& searches) {
  std::vector<Chapter> chapters;
  for (const Segment& segment : located.objects.segments) {
    Chapter chapter;
    chapter.segment = segment;
    for (const WithheldObject& object : located.found.withheld) {
      if (object.segment == segment.label) chapter.withheld = &object;
    }
    for (std::size_t i = 0; i < located.found.parts.size(); ++i) {
      if (located.found.parts[i].segment == segment.label) chapter.parts.push_back(static_cast<int>(i));
    }
    chapter.fate = !chapter.parts.empty()        ? Fate::kLocated
                   : chapter.withheld != nullptr ? Fate::kWithheld
                                                 : Fate::kTakenIn;
    for (const SearchStory& search : searches) {
      if (search.object.holds(segment.label)) chapter.searches.push_back(&search);
    }
    chapter.decisive = decisive_of(chapter);
    if (chapter.decisive != nullptr) chapter.judged = judged_of(*chapter.decisive);
    chapters.push_back(std::move(chapter));
  }
  return chapters;
}

std::string fate_of(const Chapter& chapter, const pipeline::Located& located, std::span<const PartTemplate> templates) {
  std::string words;
  for (const int index : chapter.parts) {
    const LocatedPart& part = located.found.parts[static_cast<std::size_t>(index)];
    const PartTemplate& taught = templates[static_cast<std::size_t>(part.template_index)];
    words += formatted("%sPick %d: %s, %s, coverage %.0f %%, %.3f mm RMS to the surface", words.empty() ? "" : ". ",
                       index + 1, taught.name.c_str(),
                       part.status == PoseStatus::kVerified ? "verified" : "verified up to its symmetry",
                       100.0 * part.coverage, part.rms_mm);
    words += part.grasp_index >= 0 ? formatted(", to be gripped at '%s'",
                                               taught.grasps[static_cast<std::size_t>(part.grasp_index)].name.c_str())
                                   : formatted(", not offered: %s", part.not_offered.detail);
  }
  if (chapter.withheld != nullptr) {
    const Error& reason = chapter.withheld->reason;
    words +=
        formatted("%sWithheld at the stage '%s': %s [%s]: %s",
                  words.empty() ? "" : ". The rest of it: ", stage_name(chapter.withheld->stage),
                  sentence_of(reason.code).c_str(), std::string(result_code_name(reason.code)).c_str(), reason.detail);
  }
  return words.empty() ? "Its surface belongs to a part that was found by another segment." : words + ".";
}

std::string advice_of(const Chapter& chapter, const pipeline::Located& located) {
  if (chapter.withheld != nullptr) return remedy_of(chapter.withheld->reason.code);
  for (const int index : chapter.parts) {
    const LocatedPart& part = located.found.parts[static_cast<std::size_t>(index)];
    if (part.grasp_index < 0) return remedy_of(part.not_offered.code);
  }
  return "";
}

}  // namespace beltpick::explain
