#include "result/rivalry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/kernel.hpp"
#include "base/point_block.hpp"
#include "contract/find_nearest.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::result {
namespace {

struct Tolerance {
  float off_mm, aside2_mm2;
};

// Which of the points lie on the surface, of which `near` are the nearest points: 1 or 0.
BELTPICK_KERNEL void lie_on(const PointBlock& at, const PointBlock& near, Tolerance most, std::size_t count,
                            std::int32_t* __restrict held) {
  for (std::size_t k = 0; k < count; ++k) {
    const float x = at.x[k] - near.x[k], y = at.y[k] - near.y[k], z = at.z[k] - near.z[k];
    const float off = near.nx[k] * x + near.ny[k] * y + near.nz[k] * z;
    held[k] = (std::fabs(off) < most.off_mm) & (x * x + y * y + z * z < most.aside2_mm2) ? 1 : 0;
  }
}

// Asks whether measured points lie on a part, some dozens at a time.
class OnSurface {
 public:
  OnSurface(const Rival& rival, const Scene& scene)
      : model_(rival.model),
        tolerance_mm_(static_cast<float>(surface_tolerance_mm(scene, rival.model.spacing_mm))),
        aside_mm_(1.5F * rival.model.spacing_mm + tolerance_mm_),
        into_part_(rival.T_camera_part.inverse()) {}

  // The part of the image outside which no measured point is held.
  [[nodiscard]] Region region(const PartPose& T_camera_part, const Scene& scene) const;

  // In three steps, as a NearestQuery asks: for the same points.
  void begin(const PointBlock& measured, int count) {
    move_points(measured, into_part_, count, at_);
    query_.begin(model_, at_, count);
  }
  void go_on(int count) { query_.go_on(model_, count); }
  void finish(int count) {
    PointBlock near;
    query_.finish(model_, at_, count, near);
    lie_on(at_, near, {tolerance_mm_, aside_mm_ * aside_mm_}, static_cast<std::size_t>(PointBlock::whole_steps(count)),
           held_.data());
  }
  [[nodiscard]] bool held(std::size_t k) const { return held_[k] != 0; }

 private:
  const PartModel& model_;
  float tolerance_mm_;
  float aside_mm_;
  FastMotion into_part_;
  PointBlock at_;  // part frame
  NearestQuery query_;
  alignas(64) std::array<std::int32_t, PointBlock::kSize> held_;
};

// Round the corners of the part's box. The lens draws what lies between them between where they are and where they
// would be without distortion.
Region OnSurface::region(const PartPose& T_camera_part, const Scene& scene) const {
  constexpr double kRound_px = 2.0;
  const ImageView<Vec3f>& image = scene.range.point_mm;
  Lens straight = scene.lens;
  straight.distortion = {};
  double row_min = image.rows, row_max = 0.0, col_min = image.cols, col_max = 0.0;
  const Vec3 reach_mm = Vec3::Constant(static_cast<double>(aside_mm_) + 0.1);
  const Vec3 least = model_.box_min_mm - reach_mm, most = model_.box_max_mm + reach_mm;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at =
        T_camera_part * Vec3((corner & 1) != 0 ? most.x() : least.x(), (corner & 2) != 0 ? most.y() : least.y(),
                             (corner & 4) != 0 ? most.z() : least.z());
    if (!in_field(scene.lens, at)) return {0, image.rows - 1, 0, image.cols - 1};
    for (const Lens* lens : {&scene.lens, &std::as_const(straight)}) {
      const PixelPosition seen = project(*lens, at);
      row_min = std::min(row_min, seen.row_px - kRound_px), row_max = std::max(row_max, seen.row_px + kRound_px);
      col_min = std::min(col_min, seen.column_px - kRound_px), col_max = std::max(col_max, seen.column_px + kRound_px);
    }
  }
  return {std::max(0, static_cast<int>(row_min)), std::min(image.rows - 1, static_cast<int>(row_max)),
          std::max(0, static_cast<int>(col_min)), std::min(image.cols - 1, static_cast<int>(col_max))};
}

// A pose that is right explains what another one of its size explains, but for edges, or it explains clearly more. Of
// 23 poses that were right and had such a rival, 20 explained 2 to 16 % more than it, and all 16 times as much as they
// left to it; of three that were wrong each had a rival than which it explained 1 % more at most, and 7 times as much
// as it left.
constexpr double kAllBut = 10.0;
constexpr double kClearLead = 0.013;  // of what both explain
// A part that is half hidden may be turned so that what is hidden lies elsewhere. Then a sliver of something else, or
// of the part itself, that happens to lie on the surface is a lead: of 0.8, 1.6 and 2 % in three poses that were wrong.
constexpr double kMostlySeen = 0.6;
constexpr double kHiddenLead = 0.04;

int on_lattice(int px, int step) { return px / step * step; }

// Counts measured points by which of the two holds them.
class Count {
 public:
  Count(OnSurface& first, OnSurface& second) : first_(first), second_(second) {}

  void add(const Vec3f& measured_mm) {
    waiting_.put({measured_mm, Vec3f::Zero()}, count_++);
    if (count_ == PointBlock::kSize) run();
  }
  Rivalry result() {
    run();
    return rivalry_;
  }

 private:
  void run() {
    waiting_.fill_up(count_);
    for (OnSurface* side : {&first_, &second_}) side->begin(waiting_, count_);
    for (OnSurface* side : {&first_, &second_}) side->go_on(count_);
    for (OnSurface* side : {&first_, &second_}) side->finish(count_);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
      const bool one = first_.held(k), two = second_.held(k);
      rivalry_.both += one && two ? 1 : 0;
      rivalry_.only_first += one && !two ? 1 : 0;
      rivalry_.only_second += two && !one ? 1 : 0;
    }
    count_ = 0;
  }

  OnSurface &first_, &second_;
  PointBlock waiting_;  // camera frame
  int count_ = 0;
  Rivalry rivalry_;
};

}  // namespace

Rivalry compare(const Rival& first, const Rival& second, const Scene& scene, int step) {
  OnSurface on_first(first, scene), on_second(second, scene);
  const Region a = on_first.region(first.T_camera_part, scene), b = on_second.region(second.T_camera_part, scene);
  const int row_end = std::max(a.row_max, b.row_max), col_end = std::max(a.col_max, b.col_max);
  Count count(on_first, on_second);
  for (int row = on_lattice(std::min(a.row_min, b.row_min), step); row <= row_end; row += step) {
    for (int col = on_lattice(std::min(a.col_min, b.col_min), step); col <= col_end; col += step) {
      if (scene.labels(row, col) != 0 && scene.range.valid(row, col)) count.add(scene.range.point_mm(row, col));
    }
  }
  return count.result();
}

bool prevails(const Rivalry& rivalry, double support) {
  // Along edges a pixel falls to the one or the other by chance: four standard deviations of that, and a few pixels.
  const double lead = rivalry.only_first - rivalry.only_second;
  const double chance = std::sqrt(static_cast<double>(rivalry.only_first + rivalry.only_second));
  if (lead <= 10.0 + 4.0 * chance) return false;
  if (support < kMostlySeen) return lead > kHiddenLead * rivalry.both;
  return rivalry.only_first > kAllBut * rivalry.only_second || lead > kClearLead * rivalry.both;
}

}  // namespace beltpick::result
