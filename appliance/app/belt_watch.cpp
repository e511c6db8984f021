#include "app/belt_watch.hpp"

#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"

namespace beltpick::app {

void BeltWatch::use(const Calibration& calibration, const Cell& cell) {
  std::optional<Places> places;
  if (cell.T_belt_camera) {
    const Lens& lens = calibration.camera;
    const auto& T = *cell.T_belt_camera;
    const double right = lens.width - 1.0, bottom = lens.height - 1.0;
    const std::array<std::array<double, 2>, kPlaces> pixels{
        {{right / 2, bottom / 2}, {0.0, 0.0}, {right, 0.0}, {0.0, bottom}, {right, bottom}}};
    places.emplace();
    for (std::size_t i = 0; i < kPlaces; ++i) {  // roughly there: distortion moves a place along the belt only
      const Vec3 ray((pixels[i][0] - lens.cx_px) / lens.fx_px, (pixels[i][1] - lens.cy_px) / lens.fy_px, 1.0);
      (*places)[i] = -T.translation_mm.z() / (T.rotation.row(2) * ray) * ray;
    }
  }
  if (places != places_camera_mm_) seen_ = 0;
  places_camera_mm_ = places;
}

std::optional<Error> BeltWatch::see(const std::optional<Plane>& belt) {
  if (!places_camera_mm_ || !belt) return std::nullopt;
  double most_mm = 0.0;
  for (const Vec3& place_mm : *places_camera_mm_) {
    const double nearer_mm = -belt->height_mm(place_mm);
    if (std::abs(nearer_mm) > std::abs(most_mm)) most_mm = nearer_mm;
  }
  nearer_mm_[seen_++ % kKept] = most_mm;
  const auto median_mm = nearer_mm();
  if (!median_mm || most_mm_ <= 0.0 || std::abs(*median_mm) <= most_mm_) return std::nullopt;
  return failure(ResultCode::kBeltPlaneWandered,
                 "the belt is measured up to %.2f mm %s than the cell file has it, expected at most "
                 "cycle.belt_wander_mm = %g; let the cell warm up, then 'beltpick calibrate verify' and 'beltpick "
                 "calibrate belt'",
                 std::abs(*median_mm), *median_mm > 0.0 ? "nearer" : "farther", most_mm_)
      .error();
}

std::optional<double> BeltWatch::nearer_mm() const {
  if (seen_ < kFewest) return std::nullopt;
  std::array<double, kKept> sorted = nearer_mm_;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(std::min(seen_, kKept));
  const auto middle = sorted.begin() + (end - sorted.begin()) / 2;
  std::nth_element(sorted.begin(), middle, end);
  return *middle;
}

}  // namespace beltpick::app
