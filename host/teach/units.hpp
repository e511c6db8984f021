// Units of length that mesh files come in, and what to say of a part whose size shows that another one was meant.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "base/pose.hpp"
#include "base/result.hpp"

namespace beltpick::teach {

struct Unit {
  const char* name;
  double mm;
};
inline constexpr std::array kUnits{Unit{"mm", 1.0}, Unit{"cm", 10.0}, Unit{"m", 1000.0}, Unit{"um", 0.001},
                                   Unit{"inch", 25.4}};

// Millimetres of the unit called `name`, which is one of kUnits.
double mm_per_unit(std::string_view name);

// Whether a part whose box is this, read with that many mm a unit, can be located at all. Error: kMeshInvalid where it
// is too small, too large or too far from its origin, with the unit that would make sense.
Result<void> check_size(const Vec3& box_min_mm, const Vec3& box_max_mm, double mm_per_unit);

// A word of doubt about a size that is possible but unusual; else empty.
std::string doubt_of_size(const Vec3& size_mm, double mm_per_unit);

}  // namespace beltpick::teach
