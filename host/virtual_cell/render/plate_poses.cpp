// Rejection sampling: of the poses that a capture allows, the one nearest to its share of view, height and tilt.
#include "virtual_cell/render/plate_poses.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

using PlatePose = Pose<frame::Belt, frame::Part>;

constexpr double kHighestMm = 100.0;  // of the plate's middle above the belt
constexpr double kPushOut = 1.8;
constexpr int kFlatEvery = 4;  // every fourth plate lies level
constexpr double kGolden = 0.6180339887498949;
constexpr double kPlasticX = 0.7548776662466927, kPlasticY = 0.5698402909980532;  // a sequence that fills a square

// What one capture is to show.
struct Wish {
  double tilt_rad = 0.0, towards_rad = 0.0;
  double height_mm = 0.0;                   // of the plate's middle
  Eigen::Vector2d place = {0.5, 0.5};       // of its middle, as shares of the image
  double turn_low = -kPi, turn_high = kPi;  // in the plane
};

double fraction(double x) { return x - std::floor(x); }

Wish wish_of(PlatePoses how, int k, int count, Random& random, double phase) {
  Wish wish;
  // Wished for beyond the image, so that as many plates as not are pushed against its border: lenses are worst there.
  const auto spread = [](double share) { return 0.5 + kPushOut * (share - 0.5); };
  wish.place = {spread(fraction(phase + kPlasticX * (k + 1))), spread(fraction(phase + kPlasticY * (k + 1)))};
  wish.height_mm = kHighestMm * fraction(phase + kGolden * (k + 1));
  if (how == PlatePoses::kOnBelt) {
    wish.height_mm = 0.0;
  } else if (how == PlatePoses::kNear) {
    wish = {.tilt_rad = rad_from_deg(18.0 + random.uniform(-2.0, 2.0)),
            .towards_rad = 2.0 * kPi * phase + random.uniform(-0.1, 0.1),
            .height_mm = 50.0,
            .turn_low = -0.05,
            .turn_high = 0.05};
  } else if (how != PlatePoses::kFlat && k % kFlatEvery == 0) {
    // Level ones reach what tilted ones cannot: the view just above the belt.
    const int levels = std::max((count - 1) / kFlatEvery, 1);
    wish.height_mm = kHighestMm * (k / kFlatEvery) / levels;
    constexpr std::array<std::array<double, 2>, 4> kImageCorner{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}};
    const auto& corner = kImageCorner[static_cast<std::size_t>(k / kFlatEvery) % 4];
    wish.place = {corner[0], corner[1]};
  } else if (how != PlatePoses::kFlat) {
    wish.tilt_rad = rad_from_deg(random.uniform(15.0, 33.0));
    wish.towards_rad = 2.0 * kPi * fraction(phase + static_cast<double>(k) / count * 3.0);
  }
  return wish;
}

bool within(const RichLens& lens, const Eigen::Vector2d& pixel, double margin_px) {
  return pixel.x() >= margin_px && pixel.x() <= lens.width - 1 - margin_px && pixel.y() >= margin_px &&
         pixel.y() <= lens.height - 1 - margin_px;
}

class Chooser {
 public:
  Chooser(const Rig& rig, const Plate& plate)
      : rig_(rig),
        plate_(plate),
        outline_(plate.outline_mm(0.4 * plate.options().quiet_zone_mm, 6)),
        border_(plate.outline_mm(0.0, 1)),
        middle_(plate.centre_mm()),
        projector_mm_(rig.T_projector_camera.inverse().translation_mm) {}

  // A pose with the wished tilt and the middle at the wished height, or as much higher as keeps it off the belt.
  [[nodiscard]] PlatePose tilted(const Wish& wish, double turn_rad, const Eigen::Vector2d& place) const {
    const Vec3 axis(std::cos(wish.towards_rad), std::sin(wish.towards_rad), 0.0);
    const Mat3 face_up = Vec3(1.0, -1.0, -1.0).asDiagonal();
    PlatePose pose;
    pose.rotation = Eigen::AngleAxisd(wish.tilt_rad, axis) * Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) * face_up;
    double lowest = 1e30;
    for (Vec3 corner : border_) {
      corner.z() += plate_.options().thickness_mm;
      lowest = std::min(lowest, (pose.rotation * (corner - middle_)).z());
    }
    const double height = std::max(wish.height_mm, -lowest);
    pose.translation_mm = over(place, height) - pose.rotation * middle_;
    return pose;
  }

  [[nodiscard]] bool shown_whole(const PlatePose& pose) const {
    const auto T_camera_plate = rig_.T_camera_belt * pose;
    const Vec3 facing = -T_camera_plate.rotation.col(2);
    const Vec3 middle = T_camera_plate * middle_;
    if (facing.dot(-middle.normalized()) < std::cos(rad_from_deg(48.0))) return false;
    if (facing.dot((projector_mm_ - middle).normalized()) < std::cos(rad_from_deg(62.0))) return false;
    return std::all_of(outline_.begin(), outline_.end(), [&](const Vec3& point) {
      const Vec3 seen = T_camera_plate * point;
      return within(rig_.camera, rig_.camera.project(seen), 6.0) &&
             within(rig_.projector, rig_.projector.project(rig_.T_projector_camera * seen), 3.0);
    });
  }

  [[nodiscard]] std::optional<PlatePose> choose(const Wish& wish, Random& random) const {
    constexpr int kTries = 6000, kEnough = 200;
    std::optional<PlatePose> best;
    double best_cost = 1e30;
    for (int tried = 0, found = 0; tried < kTries && found < kEnough; ++tried) {
      const Eigen::Vector2d place(random.uniform(0.05, 0.95), random.uniform(0.05, 0.95));
      const PlatePose pose = tilted(wish, random.uniform(wish.turn_low, wish.turn_high), place);
      if (!shown_whole(pose)) continue;
      ++found;
      if (const double cost = (place - wish.place).norm(); cost < best_cost) {
        best_cost = cost;
        best = pose;
      }
    }
    return best;
  }

  // Moved along the belt until a third of the print is beyond the image's border.
  [[nodiscard]] PlatePose cut_off(PlatePose pose, double towards_rad) const {
    const Vec3 step(std::cos(towards_rad), std::sin(towards_rad), 0.0);
    const std::vector<Vec3> corners = plate_.corners_mm();
    const auto cut = [&] {
      const auto T_camera_plate = rig_.T_camera_belt * pose;
      const auto gone = std::count_if(corners.begin(), corners.end(), [&](const Vec3& corner) {
        return !within(rig_.camera, rig_.camera.project(T_camera_plate * corner), 0.0);
      });
      return 3 * static_cast<std::size_t>(gone) >= corners.size();
    };
    while (!cut()) pose.translation_mm += step;
    return pose;
  }

 private:
  // The point `height_mm` above the belt that is seen at a share of the image.
  [[nodiscard]] Vec3 over(const Eigen::Vector2d& place, double height_mm) const {
    const Vec3 ray = rig_.camera.ray({place.x() * (rig_.camera.width - 1), place.y() * (rig_.camera.height - 1)});
    const Vec3 up = rig_.T_camera_belt.rotation.col(2);
    const double distance = (up.dot(rig_.T_camera_belt.translation_mm) + height_mm) / up.dot(ray);
    return rig_.T_camera_belt.inverse() * Vec3(distance * ray);
  }

  const Rig& rig_;
  const Plate& plate_;
  std::vector<Vec3> outline_, border_;
  Vec3 middle_, projector_mm_;
};

}  // namespace

Result<std::vector<PlatePose>> choose_plate_poses(const Rig& rig, const Plate& plate, PlatePoses how, int count,
                                                  std::uint64_t seed) {
  constexpr double kEaseTilt = 0.8;
  const Chooser chooser(rig, plate);
  Random random(seed, 37);
  const double phase = random.uniform();
  std::vector<PlatePose> poses;
  for (int k = 0; k < count; ++k) {
    Wish wish = wish_of(how, k, count, random, phase);
    std::optional<PlatePose> pose;
    // A plate too large to be shown whole so far up or so steep is held lower and flatter.
    for (int eased = 0; eased < 12 && !pose; ++eased) {
      pose = chooser.choose(wish, random);
      wish.tilt_rad *= kEaseTilt;
      wish.height_mm *= kEaseTilt;
    }
    if (!pose) {
      return failure(ResultCode::kValueOutOfRange,
                     "plate: expected one that fits the view, found a print of %g x %g mm; take a smaller --square-mm",
                     plate.options().board.width_mm(), plate.options().board.height_mm());
    }
    if (how == PlatePoses::kPartial && k % 3 != 0) pose = chooser.cut_off(*pose, random.uniform(0.0, 2.0 * kPi));
    poses.push_back(*pose);
  }
  return poses;
}

}  // namespace beltpick::virtual_cell
