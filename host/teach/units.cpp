#include "teach/units.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"
#include "html/page.hpp"

namespace beltpick::teach {

namespace {

using html::formatted;

// Diagonals of a part's box: below the least a scanner's noise is all there is to see, above the greatest no belt
// carries it; between the usual ones nothing needs to be said.
constexpr double kLeast_mm = 2.0;
constexpr double kUsualLeast_mm = 15.0;
constexpr double kUsualMost_mm = 700.0;
constexpr double kMost_mm = 5000.0;
constexpr double kFarthest_mm = 10000.0;  // of any coordinate: what a template may hold

std::string words(const Vec3& size_mm) {
  return formatted("%.3g x %.3g x %.3g mm", size_mm.x(), size_mm.y(), size_mm.z());
}

// The units that would give the part a usual size: "'--units inch' would make it 174 x 103 x 55 mm".
std::string advice(const Vec3& size_mm, double mm_per_unit) {
  std::string text;
  for (const Unit& unit : kUnits) {
    const Vec3 as_mm = size_mm / mm_per_unit * unit.mm;
    if (unit.mm == mm_per_unit || as_mm.norm() < kUsualLeast_mm || as_mm.norm() > kUsualMost_mm) continue;
    text +=
        text.empty() ? formatted("'--units %s' would make it ", unit.name) : formatted(", '--units %s' ", unit.name);
    text += words(as_mm);
  }
  return text.empty() ? "check the file's scale and --units" : text;
}

}  // namespace

double mm_per_unit(std::string_view name) {
  const auto* const found = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == name; });
  return found == kUnits.end() ? 1.0 : found->mm;
}

Result<void> check_size(const Vec3& box_min_mm, const Vec3& box_max_mm, double mm_per_unit) {
  const Vec3 size_mm = box_max_mm - box_min_mm;
  const double diagonal_mm = size_mm.norm();
  if (!(diagonal_mm >= kLeast_mm && diagonal_mm <= kMost_mm)) {
    return failure(ResultCode::kMeshInvalid, "the part would measure %s, expected a diagonal of %.0f to %.0f mm; %s",
                   words(size_mm).c_str(), kLeast_mm, kMost_mm, advice(size_mm, mm_per_unit).c_str());
  }
  const double farthest_mm = std::max(box_min_mm.cwiseAbs().maxCoeff(), box_max_mm.cwiseAbs().maxCoeff());
  if (farthest_mm > kFarthest_mm) {
    return failure(ResultCode::kMeshInvalid,
                   "the part lies %.0f mm from its file's origin, expected at most %.0f; move it there in CAD",
                   farthest_mm, kFarthest_mm);
  }
  return {};
}

std::string doubt_of_size(const Vec3& size_mm, double mm_per_unit) {
  if (size_mm.norm() >= kUsualLeast_mm && size_mm.norm() <= kUsualMost_mm) return {};
  return formatted("the part measures %s, which is unusually %s: %s", words(size_mm).c_str(),
                   size_mm.norm() < kUsualLeast_mm ? "small" : "large", advice(size_mm, mm_per_unit).c_str());
}

}  // namespace beltpick::teach
