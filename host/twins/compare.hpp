// Whether two taught parts can be told apart when both are looked for: what differs, where, and from which sides
// nothing of it is seen.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/part_template.hpp"

namespace beltpick::twins {

enum class Kinship : std::uint8_t {
  kStrangers,    // their surfaces differ in every pose, and from every side
  kNearTwins,    // told apart by what differs, where it is seen
  kMirrorTwins,  // one is the other's mirror image
  kSame          // nothing differs that can be measured
};

// One of 42 directions from which a part may be seen.
struct View {
  Vec3 sight = Vec3::UnitZ();   // the camera's line of sight, frame of the part seen
  double difference_mm2 = 0.0;  // least area, across the line of sight, by which the other part, in any pose, differs
};

struct Comparison {
  Kinship kinship = Kinship::kStrangers;
  double tolerance_mm = 0.0;          // what the measurement can tell: differences below do not count
  double differing_share = 0.0;       // of the taught part's surface and the other's, where they fit best
  double largest_mm = 0.0;            // the largest difference there
  Vec3 where_mm = Vec3::Zero();       // on the taught part, or on the other one (in the taught part's frame)
  double area_needed_mm2 = 0.0;       // a view that shows less of a difference does not tell
  std::vector<View> taught_as_other;  // the taught part seen: may it pass for the other?
  std::vector<View> other_as_taught;  // and the reverse

  // The shares of the views that do not tell.
  [[nodiscard]] double blind_share() const;
};

// By the whole surfaces alone, in about a second: the views stay empty. Errors: as pipeline::check_templates.
Result<Comparison> compare_whole(const PartTemplate& taught, const PartTemplate& other);

// Some 5 to 10 seconds. Errors: as pipeline::check_templates.
Result<Comparison> compare(const PartTemplate& taught, const PartTemplate& other);

// One line for a person: what the comparison says, and what follows from it. `other` is the other template's name.
std::string sentence(const Comparison& comparison, const std::string& other);

// Whether that line is a warning.
bool worrying(const Comparison& comparison);

}  // namespace beltpick::twins
