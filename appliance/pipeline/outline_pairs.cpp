#include "pipeline/outline_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace beltpick::pipeline {
namespace {

constexpr int kWindow = 2;           // cells to either side that tell which way is out
constexpr double kInsetShare = 0.4;  // of the spacing: how far the outermost of sampled points lies within the edge
constexpr int kRunInside = 3;        // pixels of the object before its end,
constexpr int kRunOutside = 2;       // and of anything else after it,
constexpr int kRunCertain = 4;  // more where the end must be certain: the edges of shadows are known to a few pixels

// What a pixel tells of the object: kUnlit, that it may go on there without having been measured.
enum class Sight : std::uint8_t { kObject, kBehind, kInFront, kNothing, kUnlit };

class OutlineWalk {
 public:
  OutlineWalk(const result::Drawing& drawing, const result::PartPose& T_camera_part, const result::Scene& scene,
              double reach_mm, double step_mm, double inset_mm, Borders borders)
      : drawing_(drawing),
        scene_(scene),
        T_part_camera_(T_camera_part.inverse()),
        reach_mm_(static_cast<float>(reach_mm)),
        step_mm_(static_cast<float>(step_mm)),
        inset_mm_(static_cast<float>(inset_mm)),
        borders_(borders) {}

  // The pair at a drawn cell, if it is one of the outline and the object's end can be seen there.
  [[nodiscard]] std::optional<icp::OutlinePair> at_cell(int row, int col) const {
    const auto out = outward(row, col);
    if (!out) return {};
    const result::Drawing::Shown edge = outermost(row, col, *out);
    const float pitch_mm = edge.point_mm.z() / static_cast<float>(scene_.lens.fx_px);
    const auto end_px = end_of_object(edge, *out, static_cast<int>(reach_mm_ / pitch_mm));
    if (!end_px) return {};
    const Vec3f outward_camera = across_sight(edge, *out);
    const Eigen::Matrix3f rotation = T_part_camera_.rotation.cast<float>();
    return icp::OutlinePair{(T_part_camera_ * edge.point_mm.cast<double>()).cast<float>(), rotation * outward_camera,
                            edge.point_mm + (*end_px * pitch_mm - inset_mm_) * outward_camera};
  }

 private:
  [[nodiscard]] bool empty(int row, int col) const {
    const auto depth = drawing_.depth_mm();
    return !depth.contains(row, col) || depth(row, col) == 0.0F;
  }

  // (column, row) direction from the drawn cells to the empty ones round this one; nothing inside the part.
  [[nodiscard]] std::optional<Eigen::Vector2f> outward(int row, int col) const {
    if (!empty(row - 1, col) && !empty(row + 1, col) && !empty(row, col - 1) && !empty(row, col + 1)) return {};
    Eigen::Vector2f sum = Eigen::Vector2f::Zero();
    for (int dr = -kWindow; dr <= kWindow; ++dr) {
      for (int dc = -kWindow; dc <= kWindow; ++dc) {
        if (empty(row + dr, col + dc)) sum += Eigen::Vector2f(static_cast<float>(dc), static_cast<float>(dr));
      }
    }
    if (sum.norm() < 2.0F) return {};
    return sum.normalized();
  }

  // Of the surface points drawn near the cell the one that lies farthest out.
  [[nodiscard]] result::Drawing::Shown outermost(int row, int col, const Eigen::Vector2f& out) const {
    result::Drawing::Shown best = drawing_.shown(row, col);
    const auto reach = [&](const result::Drawing::Shown& s) { return s.column_px * out.x() + s.row_px * out.y(); };
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        if (empty(row + dr, col + dc)) continue;
        const auto other = drawing_.shown(row + dr, col + dc);
        if (reach(other) > reach(best)) best = other;
      }
    }
    return best;
  }

  // The direction in the image as one in the camera frame, across the line of sight.
  [[nodiscard]] static Vec3f across_sight(const result::Drawing::Shown& edge, const Eigen::Vector2f& out) {
    const Vec3f sight = edge.point_mm.normalized();
    const Vec3f in_image(out.x(), out.y(), 0.0F);
    return (in_image - sight * sight.dot(in_image)).normalized();
  }

  struct Pixel {
    int row, col;
  };

  // The pixel so many pixels out from the edge.
  [[nodiscard]] static Pixel pixel_at(const result::Drawing::Shown& edge, const Eigen::Vector2f& out, int px) {
    return {static_cast<int>(std::lround(edge.row_px + static_cast<float>(px) * out.y())),
            static_cast<int>(std::lround(edge.column_px + static_cast<float>(px) * out.x()))};
  }

  // How far out from the edge that pixel's middle lies.
  [[nodiscard]] static float out_px(const result::Drawing::Shown& edge, const Eigen::Vector2f& out, int px) {
    const auto [row, col] = pixel_at(edge, out, px);
    return (static_cast<float>(col) - edge.column_px) * out.x() + (static_cast<float>(row) - edge.row_px) * out.y();
  }

  [[nodiscard]] Sight look(const result::Drawing::Shown& edge, const Eigen::Vector2f& out, int px) const {
    const auto [row, col] = pixel_at(edge, out, px);
    if (!scene_.range.point_mm.contains(row, col)) return Sight::kUnlit;
    if (!scene_.range.valid(row, col)) return lit(edge, out, px) ? Sight::kNothing : Sight::kUnlit;
    if (scene_.labels(row, col) == 0) return Sight::kBehind;
    const float behind = scene_.range.point_mm(row, col).z() - expected_depth(edge, row, col);
    if (behind > step_mm_) return Sight::kBehind;
    return behind < -step_mm_ ? Sight::kInFront : Sight::kObject;
  }

  // Whether the light is known to reach the object's surface, did it go on so far.
  [[nodiscard]] bool lit(const result::Drawing::Shown& edge, const Eigen::Vector2f& out, int px) const {
    if (borders_ == Borders::kAny || scene_.shadows == nullptr || !scene_.light_mm) return false;
    const float away_mm = static_cast<float>(px) * edge.point_mm.z() / static_cast<float>(scene_.lens.fx_px);
    const Vec3f surface_mm = edge.point_mm + away_mm * across_sight(edge, out);
    return !scene_.shadows->hides(surface_mm, -edge.point_mm.normalized(), step_mm_);
  }

  // That of the drawing; beyond its outline that of the edge.
  [[nodiscard]] float expected_depth(const result::Drawing::Shown& edge, int row, int col) const {
    const int cell_row = (row - drawing_.row_px()) / drawing_.factor();
    const int cell_col = (col - drawing_.column_px()) / drawing_.factor();
    return empty(cell_row, cell_col) ? edge.point_mm.z() : drawing_.depth_mm()(cell_row, cell_col);
  }

  // Whether the object does not go on from a pixel outwards.
  [[nodiscard]] bool ends_at(const result::Drawing::Shown& edge, const Eigen::Vector2f& out, int px) const {
    const int run = borders_ == Borders::kAny ? kRunOutside : kRunCertain;
    for (int next = 0; next < run; ++next) {
      const Sight sight = look(edge, out, px + next);
      if (sight == Sight::kObject || sight == Sight::kInFront) return false;
      if (sight == Sight::kUnlit && borders_ == Borders::kCertain) return false;
    }
    return true;
  }

  // How many pixels beyond the drawn edge the object ends: half way between the middles of its last pixel and the next,
  // wherever between pixels the edge was drawn.
  [[nodiscard]] std::optional<float> end_of_object(const result::Drawing::Shown& edge, const Eigen::Vector2f& out,
                                                   int reach_px) const {
    int inside = 0;
    for (int px = -reach_px; px <= reach_px; ++px) {
      const Sight here = look(edge, out, px);
      if (here == Sight::kInFront) return {};
      if (here == Sight::kObject) {
        ++inside;
        continue;
      }
      if (inside >= kRunInside && ends_at(edge, out, px))
        return 0.5F * (out_px(edge, out, px - 1) + out_px(edge, out, px));
      if (here == Sight::kBehind) inside = 0;
    }
    return {};
  }

  const result::Drawing& drawing_;
  const result::Scene& scene_;
  Pose<frame::Part, frame::Camera> T_part_camera_;
  float reach_mm_;
  float step_mm_;
  float inset_mm_;
  Borders borders_;
};

}  // namespace

std::size_t pair_outline(const result::Drawing& drawing, const result::PartPose& T_camera_part,
                         const result::Scene& scene, double spacing_mm, double reach_mm, double step_mm,
                         std::span<icp::OutlinePair> out, Borders borders) {
  const OutlineWalk walk(drawing, T_camera_part, scene, reach_mm, step_mm, kInsetShare * spacing_mm, borders);
  const auto depth = drawing.depth_mm();
  std::size_t count = 0;
  for (int row = 0; row < depth.rows; ++row) {
    for (int col = 0; col < depth.cols && count < out.size(); ++col) {
      if (depth(row, col) == 0.0F) continue;
      const auto pair = walk.at_cell(row, col);
      if (pair) out[count++] = *pair;
    }
  }
  return count;
}

}  // namespace beltpick::pipeline
