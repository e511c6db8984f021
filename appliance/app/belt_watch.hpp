// BeltWatch: whether the belt still lies where the cell file has it. Camera and projector that warm up, or were
// knocked, measure it elsewhere; every capture tells, with no plate and no further frame.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"

namespace beltpick::app {

class BeltWatch {
 public:
  // `most_mm`: farther is worth a finding; 0: nothing is.
  explicit BeltWatch(double most_mm) : most_mm_(most_mm) {}

  // What was seen so far counts on only where the belt stays at its place in the camera frame. A cell that does not
  // tell where its belt is is not watched.
  void use(const Calibration& calibration, const Cell& cell);

  // The plane that carries the objects of a capture. Finding, once some captures agree: kBeltPlaneWandered.
  std::optional<Error> see(const std::optional<Plane>& belt);

  // The median over the last captures of how much nearer to the camera the belt is, where in view that is most; nothing
  // before some were seen. The median: a box that covers the belt once is not the belt.
  [[nodiscard]] std::optional<double> nearer_mm() const;

 private:
  static constexpr std::size_t kKept = 9, kFewest = 5;
  static constexpr std::size_t kPlaces = 5;  // the middle of the view and its corners
  using Places = std::array<Vec3, kPlaces>;

  double most_mm_;
  std::optional<Places> places_camera_mm_;  // on the belt as the cell file has it
  std::array<double, kKept> nearer_mm_{};   // of the last captures, in a ring
  std::size_t seen_ = 0;
};

}  // namespace beltpick::app
