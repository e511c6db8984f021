// Evidence: the whole range image for and against a pose: the part drawn, and every point in sight looked up.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "contract/part_model.hpp"
#include "result/blemish.hpp"
#include "result/drawing.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

// Shares are by area across the line of sight.
struct Evidence {
  double in_view = 0.0;       // of what the camera could see of the part, what lies inside the image
  double matched = 0.0;       // what was measured where the pose says: points as wide as one seen straight on
  double support = 0.0;       // of what the camera could see of the part, what was measured where the pose says
  double coverage = 0.0;      // the same, of what lies inside the image, behind nothing else and in no shadow
  double violated = 0.0;      // of that, what was seen to be empty: measured clearly behind
  double contradicted = 0.0;  // of what was measured at all there, what lies off the surface, in front or behind
  double occluded = 0.0;      // of what lies inside the image, what something measured in front hides
  double shadowed = 0.0;      // of what lies inside the image, what is missing and lies in a cast shadow
  double unexplained =
      0.0;  // of what lies inside the image, what the object itself hides: it has more to it than the part
  double continued = 0.0;  // of the outline, where the object goes on as if it were larger than the part
  double gaps =
      0.0;  // of what the camera could see of the part, what is missing for no known reason; 0 without a light
  double sunk = 0.0;    // of the part's whole surface, what would lie under the belt
  double rms_mm = 0.0;  // of the measured points to the surface, where they support the pose
  int points = 0;       // of the template, in sight and inside the image
  Blemishes blemishes;  // looked for only when a pose is finished
};

// The object that the pose is to explain: pixels of `owner` that hold one of `labels`. Empty: not told.
struct Claimed {
  ImageView<const std::uint16_t> owner{};
  std::span<const std::uint16_t> labels{};

  [[nodiscard]] bool holds(int row, int col) const {
    return !owner.empty() && std::find(labels.begin(), labels.end(), owner(row, col)) != labels.end();
  }
};

// What one surface point in sight met in the range image.
enum class Finding : std::uint8_t {
  kMatched,       // measured where the pose says
  kViolated,      // seen to be empty: measured clearly behind
  kOccluded,      // something was measured clearly in front
  kContradicted,  // measured a little off the surface, in front or behind
  kMissing,       // not measured, though the light should have reached it
  kShadowed       // not measured, and in a cast shadow or among places that were only just measured
};
inline constexpr std::size_t kFindingCount = 6;

// Whoever wants to know of each point what it met.
class FindingListener {
 public:
  FindingListener() = default;
  FindingListener(const FindingListener&) = delete;
  FindingListener& operator=(const FindingListener&) = delete;
  virtual ~FindingListener() = default;
  virtual void found(const VisiblePoint& point, Finding finding) = 0;
};

// Looks up the part as it was drawn.
Evidence weigh(const Drawing& drawing, const PartModel& model, const PartPose& T_camera_part, const Scene& scene,
               const Claimed& claimed = {}, FindingListener* listener = nullptr);

// The share of the part's surface points that lies clearly under the belt, where no part can be.
double sunk_share(const PartModel& model, const PartPose& T_camera_part, const Plane& belt, double tolerance_mm);

// A first impression of a pose, from the model's scattered points alone, without hidden surfaces removed.
struct Impression {
  // The share that was measured where the pose says minus twice the share seen to be empty. What cannot be judged,
  // being hidden or outside the image, counts half in the whole. In [-2, 1].
  double score = -2.0;
  double seen_empty = 0.0;  // of what can be judged
};
Impression first_impression(const PartModel& model, const PartPose& T_camera_part, const Scene& scene,
                            double tolerance_mm);

}  // namespace beltpick::result
