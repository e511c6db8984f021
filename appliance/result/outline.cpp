#include "result/outline.hpp"

#include <array>
#include <cmath>
#include <optional>

namespace beltpick::result {
namespace {

constexpr int kLeastJudged = 16;
// So far inside the outline the object is looked at, and at the very edge where a face is narrow: there a part may be
// rounded off, and its surface does not point to where a larger object would go on.
constexpr std::array<int, 2> kInsideCells{3, 1};
constexpr int kOutsideCells = 3;

struct Direction {
  int row, col;
};

class OutlineJudge {
 public:
  OutlineJudge(const Drawing& drawing, const PartModel& model, const PartPose& T_camera_part, const Scene& scene,
               double tolerance_mm)
      : drawing_(drawing),
        model_(model),
        scene_(scene),
        T_part_camera_(T_camera_part.inverse()),
        rotation_(T_camera_part.rotation.cast<float>()),
        tolerance_mm_(static_cast<float>(tolerance_mm)) {}

  double continued_share() {
    const auto depth = drawing_.depth_mm();
    for (int row = 0; row < depth.rows; ++row) {
      for (int col = 0; col < depth.cols; ++col) {
        if (depth(row, col) == 0.0F) continue;
        for (const Direction& out : {Direction{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          if (empty(row + out.row, col + out.col)) judge(row, col, out);
        }
      }
    }
    return judged_ < kLeastJudged ? 0.0 : static_cast<double>(continued_) / judged_;
  }

 private:
  struct Pixel {
    int row, col;
  };

  [[nodiscard]] bool empty(int row, int col) const {
    const auto depth = drawing_.depth_mm();
    return depth.contains(row, col) && depth(row, col) == 0.0F;
  }

  // The image pixel at the middle of a cell, where it was measured.
  [[nodiscard]] std::optional<Pixel> measured_pixel(int row, int col) const {
    const Pixel pixel{drawing_.row_px() + row * drawing_.factor() + drawing_.factor() / 2,
                      drawing_.column_px() + col * drawing_.factor() + drawing_.factor() / 2};
    if (!scene_.range.point_mm.contains(pixel.row, pixel.col) || !scene_.range.valid(pixel.row, pixel.col)) return {};
    return pixel;
  }

  void judge(int row, int col, const Direction& out) {
    const int far_row = row + kOutsideCells * out.row;
    const int far_col = col + kOutsideCells * out.col;
    const auto depth = drawing_.depth_mm();
    if (depth.contains(far_row, far_col) && depth(far_row, far_col) != 0.0F) return;  // the part itself again
    const auto outside = measured_pixel(far_row, far_col);
    if (!outside) return;
    bool on_part = false, goes_on = false;
    for (const int cells : kInsideCells) {
      const auto inside = measured_pixel(row - cells * out.row, col - cells * out.col);
      const OrientedPoint* nearest = inside ? on_surface(*inside) : nullptr;
      if (nearest == nullptr) continue;
      on_part = true;
      goes_on = goes_on || continues(*inside, rotation_ * nearest->normal, *outside);
    }
    judged_ += on_part ? 1 : 0;
    continued_ += goes_on ? 1 : 0;
  }

  // The part's surface that was measured at a pixel, or nothing.
  [[nodiscard]] const OrientedPoint* on_surface(const Pixel& pixel) const {
    const Vec3f at = (T_part_camera_ * scene_.range.point_mm(pixel.row, pixel.col).cast<double>()).cast<float>();
    const OrientedPoint& nearest = model_.nearest(at);
    return std::abs(nearest.normal.dot(at - nearest.point_mm)) > tolerance_mm_ ? nullptr : &nearest;
  }

  // Whether the object measured at one pixel reaches the other one along the surface of that normal.
  [[nodiscard]] bool continues(const Pixel& inside, const Vec3f& normal, const Pixel& outside) const {
    const std::uint16_t label = scene_.labels(inside.row, inside.col);
    if (label == 0 || scene_.labels(outside.row, outside.col) != label) return false;
    const Vec3f across =
        scene_.range.point_mm(outside.row, outside.col) - scene_.range.point_mm(inside.row, inside.col);
    return std::abs(normal.dot(across)) < tolerance_mm_ + 0.1F * across.norm();
  }

  const Drawing& drawing_;
  const PartModel& model_;
  const Scene& scene_;
  Pose<frame::Part, frame::Camera> T_part_camera_;
  Eigen::Matrix3f rotation_;
  float tolerance_mm_;
  int judged_ = 0;
  int continued_ = 0;
};

}  // namespace

double continued_outline(const Drawing& drawing, const PartModel& model, const PartPose& T_camera_part,
                         const Scene& scene, double tolerance_mm) {
  return OutlineJudge(drawing, model, T_camera_part, scene, tolerance_mm).continued_share();
}

}  // namespace beltpick::result
